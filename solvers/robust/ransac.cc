// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <span>

#include "solvers/core/inner_solver.h"
#include "solvers/core/registry.h"
#include "solvers/pnp/p3p_solver.h"
#include "solvers/robust/p3p_consensus.h"
#include "solvers/robust/pair_scorer.h"
#include "solvers/robust/sample_consensus.h"

namespace sextant {
namespace {

enum class Refit { kNone, kInliers };

struct RansacOptions : InlierOptions {
  int sample_size = 0;
  int max_iterations = 10000;
  double confidence = 0.999;
  int local_optimisation = 10;
  Refit refit = Refit::kInliers;
  int min_inliers = 0;
  std::uint64_t seed = 1;
};

DataNeeds WithSample(const DataNeeds& inner, PairKind kind, int sample_size) {
  DataNeeds needs = NeedsOfConsensus(inner, kind);
  int& count = kind == PairKind::k3d3d ? needs.pairs_3d3d : needs.pairs_2d3d;
  count = std::max(count, sample_size);
  return needs;
}

/// Random sample consensus (Fischler and Bolles 1981) around any solver of pairs: MSAC cost in
/// sigmas (Torr and Zisserman 2000), samples until `confidence`, least squares on the inliers of
/// each new best (Lebeda, Matas and Chum 2012, LO+-RANSAC), then the inner solver on all inliers.
///
/// The inner's refit is taken unless it costs more than least squares on the same inliers, as that
/// of a minimal solver or of EPnP may; then least squares is the answer. Around p3p the search is
/// FindP3pConsensus where the camera has no distortion. The paper's plain scheme:
/// sample_size=15, max_iterations=10000, local_optimisation=0. Errors: kDegenerate (1000 samples
/// and not one pose), kNoConsensus (see CheckConsensus), kMirrored.
class RansacSolver final : public Solver {
 public:
  RansacSolver(const SolverArguments& arguments, PairKind kind, const RansacOptions& options)
      : Solver({.name = arguments.name,
                .needs = WithSample(arguments.inner->spec().needs, kind, options.sample_size),
                .estimates_rotation = arguments.inner->spec().estimates_rotation,
                .is_global = arguments.inner->spec().is_global}),
        inner_(arguments.inner),
        kind_(kind),
        options_(options) {}

 private:
  Expected<Estimate> DoSolve(const CalibrationProblem& problem) const override {
    const SampleOptions sampling = {.sample_size = options_.sample_size > 0
                                                       ? options_.sample_size
                                                       : MinPairs(inner_->spec().needs),
                                    .max_iterations = options_.max_iterations,
                                    .confidence = options_.confidence,
                                    .local_optimisation = options_.local_optimisation,
                                    .seed = options_.seed};
    if (kind_ == PairKind::k3d3d && spec().estimates_rotation && AreIsotropic(problem.pairs_3d3d)) {
      return SolveInColumns(problem, sampling);
    }
    const PairTerms terms = MakeTerms(problem, kind_, options_.Assumed());
    const PoseScorer scorer(terms, options_.MaxSquared(kind_));
    if (sampling.sample_size == 3 && options_.local_optimisation > 0 &&
        IsP3pOfPinhole(*inner_, problem)) {
      return SolveByTriples(terms, scorer);
    }
    TermsConsensus consensus(terms, scorer);
    return SolveBySamples(
        problem, sampling, consensus,
        [&](const Rigid3d& pose) { return Finish(problem, terms, scorer, pose); },
        [&](std::span<const int> inliers) {
          return CheckConsensus(terms, scorer, inliers, LeastInliers());
        });
  }

  // Isotropic 3D-3D pairs.
  Expected<Estimate> SolveInColumns(const CalibrationProblem& problem,
                                    const SampleOptions& sampling) const {
    const double max_squared = options_.MaxSquared(kind_);
    const PairColumns pairs(problem.pairs_3d3d, options_.Assumed());
    ColumnsConsensus consensus(pairs, max_squared);
    return SolveBySamples(
        problem, sampling, consensus,
        [&](const Rigid3d& pose) { return FinishInColumns(problem, pairs, max_squared, pose); },
        [&](std::span<const int> inliers) {
          return CheckConsensus(pairs, max_squared, inliers, LeastInliers());
        });
  }

  // The answer from the best sample's pose, and the verdict on its inliers.
  template <class Consensus, class FinishFrom, class Check>
  Expected<Estimate> SolveBySamples(const CalibrationProblem& problem,
                                    const SampleOptions& sampling, Consensus& consensus,
                                    const FinishFrom& finish_from, const Check& check) const {
    SampleSearch search(*inner_, sampling, problem, consensus);
    search.Run();
    if (!search.found()) return NoPose(search.iterations(), sampling.sample_size);
    Expected<Estimate> estimate = finish_from(search.best());
    if (!estimate) return estimate;
    SEXTANT_RETURN_IF_ERROR(check(estimate->inliers));
    return Checked(problem, search.iterations(), std::move(*estimate));
  }

  // Of mirrored points, those near one plane agree on a pose, which is not the answer.
  Expected<Estimate> Checked(const CalibrationProblem& problem, int iterations,
                             Estimate estimate) const {
    const std::size_t count =
        kind_ == PairKind::k3d3d ? problem.pairs_3d3d.size() : problem.pairs_2d3d.size();
    if (2 * estimate.inliers.size() < count) {
      Expected<Estimate> of_all = SolveWhole(*inner_, problem);
      if (!of_all && of_all.error().code == ErrorCode::kMirrored) return of_all;
    }
    estimate.iterations = iterations;
    estimate.termination = iterations < options_.max_iterations ? Termination::kConverged
                                                                : Termination::kMaxIterations;
    return estimate;
  }

  // The same search around p3p, whose refit on the inliers would be worse than least squares.
  Expected<Estimate> SolveByTriples(const PairTerms& terms, const PoseScorer& scorer) const {
    const P3pConsensus found = FindP3pConsensus(terms.pixels.View(), terms.camera,
                                                {.max_squared = scorer.max_squared(),
                                                 .confidence = options_.confidence,
                                                 .max_samples = options_.max_iterations,
                                                 .local_rounds = options_.local_optimisation,
                                                 .seed = options_.seed});
    if (!found.found) return NoPose(found.samples, 3);
    Estimate estimate = LeastSquaresOnInliers(terms, scorer, found.cam_from_lidar);
    SEXTANT_RETURN_IF_ERROR(CheckConsensus(terms, scorer, estimate.inliers, LeastInliers()));
    estimate.iterations = found.samples;
    estimate.termination = found.samples < options_.max_iterations ? Termination::kConverged
                                                                   : Termination::kMaxIterations;
    return estimate;
  }

  int LeastInliers() const {
    return std::max(options_.min_inliers, MinPairs(inner_->spec().needs) + 1);
  }

  static tl::unexpected<Error> NoPose(int samples, int sample_size) {
    return MakeError(ErrorCode::kDegenerate,
                     fmt::format("none of {} samples of {} pairs determines a pose; the points "
                                 "coincide or lie on one line",
                                 samples, sample_size));
  }

  Expected<Estimate> Finish(const CalibrationProblem& problem, const PairTerms& terms,
                            const PoseScorer& scorer, const Rigid3d& pose) const {
    if (options_.refit == Refit::kNone) return LeastSquaresOnInliers(terms, scorer, pose);
    if (options_.local_optimisation == 0) return RefitOnInliers(*inner_, problem, scorer, pose);
    return BetterOnInliers(*inner_, problem, terms, scorer, pose);
  }

  Expected<Estimate> FinishInColumns(const CalibrationProblem& problem, const PairColumns& pairs,
                                     double max_squared, const Rigid3d& pose) const {
    if (options_.refit == Refit::kInliers) {
      if (options_.local_optimisation == 0) {
        return RefitOnInliers(*inner_, problem, pairs, pose, max_squared);
      }
      std::optional<Estimate> refit = RefitIfNoWorse(*inner_, problem, pairs, pose, max_squared);
      if (refit) return std::move(*refit);
    }
    const PairTerms terms = MakeTerms(problem, kind_, options_.Assumed());
    return Finish(problem, terms, PoseScorer(terms, max_squared), pose);
  }

  SolverPtr inner_;
  PairKind kind_;
  RansacOptions options_;
};

OptionSet<RansacOptions> RansacOptionSet() {
  OptionSet<RansacOptions> options;
  options
      .Count("sample_size", &RansacOptions::sample_size, 0, 1000,
             "pairs a sample; 0: as few as the inner solver needs")
      .Count("max_iterations", &RansacOptions::max_iterations, 1, 100'000'000, "most samples drawn")
      .Real("confidence", &RansacOptions::confidence, "1", 0.0, 1.0 - 1e-12,
            "probability of having drawn a sample without outliers when the search stops")
      .Count("local_optimisation", &RansacOptions::local_optimisation, 0, 1000,
             "most rounds of least squares on the inliers of a new best; 0: none")
      .Choice("refit", &RansacOptions::refit, {"none", "inliers"},
              "the inner solver on all inliers at the end")
      .Count("min_inliers", &RansacOptions::min_inliers, 0, 1'000'000'000,
             "fewer are kNoConsensus; 0: one beyond what the inner solver needs")
      .Count("seed", &RansacOptions::seed, 0, 1'000'000'000'000, "of the samples");
  return AddInlierOptions(options);
}

}  // namespace

SolverEntry RansacEntry() {
  return {
      .name = "ransac",
      .summary = "random samples, the pose that most pairs agree on, the inner solver on these",
      .needs = "what the inner solver needs and at least one pair more",
      .reference = "Fischler and Bolles 1981; Torr and Zisserman 2000; Lebeda et al. 2012",
      .example = "ransac(kabsch)",
      .wraps_solver = true,
      .options = RansacOptionSet().Describe(),
      .make = [](const SolverArguments& arguments) -> Expected<SolverPtr> {
        SEXTANT_ASSIGN_OR_RETURN(const RansacOptions options,
                                 RansacOptionSet().Parse(arguments.options));
        SEXTANT_ASSIGN_OR_RETURN(const PairKind kind, KindOfPairs(*arguments.inner, "ransac"));
        const int least = MinPairs(arguments.inner->spec().needs);
        if (options.sample_size > 0 && options.sample_size < least) {
          return MakeError(ErrorCode::kInvalidOption,
                           fmt::format("option sample_size={}: '{}' needs at least {} pairs",
                                       options.sample_size, arguments.inner->spec().name, least));
        }
        return std::make_shared<RansacSolver>(arguments, kind, options);
      },
  };
}

}  // namespace sextant
