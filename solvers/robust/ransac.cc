// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include "base/random.h"
#include "solvers/core/inner_solver.h"
#include "solvers/core/registry.h"
#include "solvers/pnp/p3p_solver.h"
#include "solvers/robust/consensus.h"
#include "solvers/robust/noise_scale.h"
#include "solvers/robust/p3p_consensus.h"
#include "solvers/robust/term_scorer.h"

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

struct SampleOptions {
  int sample_size = 3;
  int max_iterations = 10000;
  double confidence = 0.999;
  int local_optimisation = 10;  // Rounds; 0: none.
  std::uint64_t seed = 1;
};

/// The cheapest pose of random samples of pairs. Every buffer is allocated before the search, none
/// in its loop.
class SampleSearch {
 public:
  SampleSearch(const Solver& inner, const SampleOptions& options, const CalibrationProblem& problem,
               PairScorer& scorer, double max_squared)
      : inner_(inner),
        options_(options),
        problem_(problem),
        scorer_(scorer),
        max_squared_(max_squared),
        random_(options.seed),
        sample_(static_cast<std::size_t>(options.sample_size)) {
    poses_.reserve(8);
    inliers_.reserve(scorer.size());
  }

  void Run() {
    // After this many degenerate samples and no other, the data itself is degenerate.
    constexpr int kMaxFailedSamples = 1000;
    double wanted = options_.max_iterations;
    while (iterations_ < wanted && (found_ || iterations_ < kMaxFailedSamples)) {
      ++iterations_;
      random_.Sample(static_cast<int>(scorer_.size()), sample_);
      poses_.clear();
      inner_.Hypothesize(problem_, sample_, poses_);
      for (const Rigid3d& pose : poses_) {
        if (!TakeIfCheaper(pose)) continue;
        if (options_.local_optimisation > 0) {
          Optimise({.max_iterations = 4, .step_tolerance = 1e-6});
        }
        scorer_.Inliers(best_, max_squared_, inliers_);
        wanted = std::min<double>(options_.max_iterations,
                                  WantedSamples(scorer_.size(), inliers_.size(),
                                                options_.sample_size, options_.confidence));
      }
    }
    if (found_) Optimise({.max_iterations = 30, .step_tolerance = 1e-10});
  }

  bool found() const { return found_; }
  const Rigid3d& best() const { return best_; }
  int iterations() const { return iterations_; }

 private:
  void Optimise(const RefineLimits& limits) {
    if (!inner_.spec().estimates_rotation) return;
    TakeIfCheaper(
        OptimiseOnInliers(scorer_, best_, max_squared_, options_.local_optimisation, limits));
  }

  bool TakeIfCheaper(const Rigid3d& pose) {
    if (!pose.IsFinite()) return false;
    const double cost = scorer_.CostUpTo(pose, max_squared_, best_cost_);
    if (found_ && !(cost < best_cost_)) return false;
    best_cost_ = cost;
    best_ = pose;
    found_ = true;
    return true;
  }

  const Solver& inner_;
  const SampleOptions& options_;
  const CalibrationProblem& problem_;
  PairScorer& scorer_;
  double max_squared_;
  Random random_;
  std::vector<int> sample_;
  std::vector<Rigid3d> poses_;
  std::vector<int> inliers_;
  Rigid3d best_;
  double best_cost_ = std::numeric_limits<double>::infinity();
  bool found_ = false;
  int iterations_ = 0;
};

/// Random sample consensus (Fischler and Bolles 1981) around any solver of pairs: MSAC cost in
/// sigmas (Torr and Zisserman 2000), samples until `confidence`, least squares on the inliers of
/// each new best (Lebeda, Matas and Chum 2012, LO+-RANSAC), then the inner solver on all inliers.
///
/// The inner solver's refit is taken unless it costs more than least squares on the same inliers,
/// as that of a minimal solver or of EPnP may; then least squares is the answer. Around p3p the
/// search is FindP3pConsensus where the camera has no distortion. The paper's scheme is
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
    return SolveWithNoise(problem, kind_, options_, *inner_, options_.seed,
                          [this](const CalibrationProblem& stated) { return SolveStated(stated); });
  }

  // Requires pairs that state their noise.
  Expected<Estimate> SolveStated(const CalibrationProblem& problem) const {
    const SampleOptions sampling = {.sample_size = options_.sample_size > 0
                                                       ? options_.sample_size
                                                       : MinPairs(inner_->spec().needs),
                                    .max_iterations = options_.max_iterations,
                                    .confidence = options_.confidence,
                                    .local_optimisation = options_.local_optimisation,
                                    .seed = options_.seed};
    const double max_squared = options_.MaxSquared(kind_);
    if (sampling.sample_size == 3 && options_.local_optimisation > 0 &&
        IsP3pOfPinhole(*inner_, problem)) {
      return SolveByTriples(TermScorer(MakeTerms(problem, kind_)), max_squared);
    }
    const std::unique_ptr<PairScorer> scorer = MakePairScorer(problem, kind_);
    SampleSearch search(*inner_, sampling, problem, *scorer, max_squared);
    search.Run();
    if (!search.found()) return NoPose(search.iterations(), sampling.sample_size);
    Expected<Estimate> estimate =
        Finish(problem, *scorer, search.best(), options_.FinalMaxSquared(*scorer));
    if (!estimate) return estimate;
    SEXTANT_RETURN_IF_ERROR(CheckConsensus(*scorer, estimate->cam_from_lidar, max_squared,
                                           estimate->inliers, MinInliers()));
    if (2 * estimate->inliers.size() < scorer->size()) {
      // If the points are mirrored, those near one plane agree on a pose, which is not the answer.
      Expected<Estimate> of_all = SolveWhole(*inner_, problem);
      if (!of_all && of_all.error().code == ErrorCode::kMirrored) return of_all;
    }
    SetIterations(search.iterations(), *estimate);
    return estimate;
  }

  // The same search around p3p, whose refit on the inliers would be worse than least squares.
  Expected<Estimate> SolveByTriples(TermScorer&& scorer, double max_squared) const {
    const PairTerms& terms = scorer.terms();
    const P3pConsensus found = FindP3pConsensus(terms.pixels.View(), terms.camera,
                                                {.max_squared = max_squared,
                                                 .confidence = options_.confidence,
                                                 .max_samples = options_.max_iterations,
                                                 .local_rounds = options_.local_optimisation,
                                                 .seed = options_.seed});
    if (!found.found) return NoPose(found.samples, 3);
    // The search's rounds of least squares may end before the minimum where the pairs are few.
    const auto fit = scorer.FitInliers(found.cam_from_lidar, max_squared, {});
    Estimate estimate = LeastSquaresOnInliers(
        scorer, fit && fit->IsFinite() ? *fit : found.cam_from_lidar, max_squared);
    SEXTANT_RETURN_IF_ERROR(CheckConsensus(scorer, estimate.cam_from_lidar, max_squared,
                                           estimate.inliers, MinInliers()));
    SetIterations(found.samples, estimate);
    return estimate;
  }

  int MinInliers() const {
    return std::max(options_.min_inliers, MinPairs(inner_->spec().needs) + 1);
  }

  void SetIterations(int iterations, Estimate& estimate) const {
    estimate.iterations = iterations;
    estimate.termination = iterations < options_.max_iterations ? Termination::kConverged
                                                                : Termination::kMaxIterations;
  }

  static tl::unexpected<Error> NoPose(int samples, int sample_size) {
    return MakeError(ErrorCode::kDegenerate,
                     fmt::format("none of {} samples of {} pairs determines a pose; the points "
                                 "coincide or lie on one line",
                                 samples, sample_size));
  }

  Expected<Estimate> Finish(const CalibrationProblem& problem, PairScorer& scorer,
                            const Rigid3d& pose, double max_squared) const {
    if (options_.refit == Refit::kNone) return LeastSquaresOnInliers(scorer, pose, max_squared);
    if (options_.local_optimisation == 0) {
      return RefitOnInliers(*inner_, problem, scorer, pose, max_squared);
    }
    return BetterOnInliers(*inner_, problem, scorer, pose, max_squared);
  }

  SolverPtr inner_;
  PairKind kind_;
  RansacOptions options_;
};

OptionSet<RansacOptions> RansacOptionSet() {
  OptionSet<RansacOptions> options;
  options
      .Count("sample_size", &RansacOptions::sample_size, 0, 1000,
             "pairs per sample; 0: as few as the inner solver needs")
      .Count("max_iterations", &RansacOptions::max_iterations, 1, 100'000'000,
             "maximum number of samples")
      .Real("confidence", &RansacOptions::confidence, "1", 0.0, 1.0 - 1e-12,
            "probability of having drawn a sample without outliers when the search stops")
      .Count("local_optimisation", &RansacOptions::local_optimisation, 0, 1000,
             "maximum rounds of least squares on the inliers of a new best pose; 0: none")
      .Choice("refit", &RansacOptions::refit, {"none", "inliers"},
              "the inner solver on all inliers at the end")
      .Count("min_inliers", &RansacOptions::min_inliers, 0, 1'000'000'000,
             "fewer inliers are kNoConsensus; 0: one more than the inner solver needs")
      .Count("seed", &RansacOptions::seed, 0, 1'000'000'000'000, "seed of the samples");
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
        const int min_pairs = MinPairs(arguments.inner->spec().needs);
        if (options.sample_size > 0 && options.sample_size < min_pairs) {
          return MakeError(
              ErrorCode::kInvalidOption,
              fmt::format("option sample_size={}: '{}' needs at least {} pairs",
                          options.sample_size, arguments.inner->spec().name, min_pairs));
        }
        return std::make_shared<RansacSolver>(arguments, kind, options);
      },
  };
}

}  // namespace sextant
