// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/random.h"
#include "solvers/consensus.h"
#include "solvers/p3p_consensus.h"
#include "solvers/p3p_solver.h"
#include "solvers/pose_scorer.h"
#include "solvers/refine_pose.h"
#include "solvers/registry.h"

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

// After this many degenerate samples and no other, the data itself is degenerate.
constexpr int kMaxDegenerateSamples = 1000;
constexpr RefineLimits kLocalLimits{.max_iterations = 4, .step_tolerance = 1e-6};
constexpr RefineLimits kFinalLimits{.max_iterations = 30, .step_tolerance = 1e-10};

/// One search: every buffer is allocated here, none in the loop.
class ConsensusSearch {
 public:
  ConsensusSearch(const Solver& inner, const RansacOptions& options, int sample_size,
                  const CalibrationProblem& problem, const PairTerms& terms,
                  const PoseScorer& scorer)
      : inner_(inner),
        options_(options),
        problem_(problem),
        terms_(terms),
        scorer_(scorer),
        random_(options.seed),
        sample_(static_cast<std::size_t>(sample_size)) {
    poses_.reserve(8);
    workspace_.inliers.reserve(terms.size());
    workspace_.terms.points.reserve(terms.points.size());
    workspace_.terms.pixels.reserve(terms.pixels.size());
  }

  void Run() {
    double wanted = options_.max_iterations;
    while (iterations_ < wanted && (found_ || iterations_ < kMaxDegenerateSamples)) {
      ++iterations_;
      random_.Sample(static_cast<int>(terms_.size()), sample_);
      poses_.clear();
      inner_.Hypothesize(problem_, sample_, poses_);
      for (const Rigid3d& pose : poses_) {
        if (!Offer(pose)) continue;
        if (options_.local_optimisation > 0) Optimise();
        scorer_.Inliers(best_, workspace_.inliers);
        wanted =
            std::min<double>(options_.max_iterations, WantedIterations(workspace_.inliers.size()));
      }
    }
  }

  bool found() const { return found_; }
  const Rigid3d& best() const { return best_; }
  int iterations() const { return iterations_; }
  bool exhausted() const { return iterations_ >= options_.max_iterations; }

  void Optimise(const RefineLimits& limits = kLocalLimits) {
    if (!inner_.spec().estimates_rotation) return;
    Offer(
        OptimiseOnInliers(terms_, scorer_, best_, options_.local_optimisation, limits, workspace_));
  }

 private:
  // Takes a pose that costs less than the best.
  bool Offer(const Rigid3d& pose) {
    if (!pose.IsFinite()) return false;
    const double cost = scorer_.Cost(pose, best_cost_);
    if (found_ && !(cost < best_cost_)) return false;
    best_cost_ = cost;
    best_ = pose;
    found_ = true;
    return true;
  }

  // Samples until one of inliers only has been drawn with the wanted confidence.
  double WantedIterations(std::size_t inlier_count) const {
    const double n = static_cast<double>(terms_.size());
    double all_inliers = 1.0;
    for (std::size_t i = 0; i < sample_.size(); ++i) {
      const double drawn = static_cast<double>(i);
      all_inliers *= std::max(0.0, static_cast<double>(inlier_count) - drawn) / (n - drawn);
    }
    if (all_inliers >= 1.0) return 1.0;
    return std::ceil(std::log1p(-options_.confidence) / std::log1p(-all_inliers));
  }

  const Solver& inner_;
  const RansacOptions& options_;
  const CalibrationProblem& problem_;
  const PairTerms& terms_;
  const PoseScorer& scorer_;
  Random random_;
  std::vector<int> sample_;
  std::vector<Rigid3d> poses_;
  InlierWorkspace workspace_;
  Rigid3d best_;
  double best_cost_ = std::numeric_limits<double>::infinity();
  bool found_ = false;
  int iterations_ = 0;
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
    const int sample_size =
        options_.sample_size > 0 ? options_.sample_size : LeastPairs(inner_->spec().needs);
    const PairTerms terms = MakeTerms(problem, kind_, options_.Assumed());
    const PoseScorer scorer(terms, options_.MaxSquared(kind_));
    if (sample_size == 3 && options_.local_optimisation > 0 && IsP3pOfPinhole(*inner_, problem)) {
      return SolveByTriples(terms, scorer);
    }
    ConsensusSearch search(*inner_, options_, sample_size, problem, terms, scorer);
    search.Run();
    if (!search.found()) return NoPose(search.iterations(), sample_size);
    search.Optimise(kFinalLimits);
    Expected<Estimate> estimate = Finish(problem, terms, scorer, search.best());
    if (!estimate) return estimate;
    if (Expected<void> ok = CheckConsensus(terms, scorer, estimate->inliers, LeastInliers()); !ok) {
      return tl::unexpected<Error>(std::move(ok.error()));
    }
    if (2 * estimate->inliers.size() < terms.size()) {
      if (Expected<void> ok = CheckNotMirrored(problem, terms); !ok) {
        return tl::unexpected<Error>(std::move(ok.error()));
      }
    }
    estimate->iterations = search.iterations();
    estimate->termination =
        search.exhausted() ? Termination::kMaxIterations : Termination::kConverged;
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
    if (Expected<void> ok = CheckConsensus(terms, scorer, estimate.inliers, LeastInliers()); !ok) {
      return tl::unexpected<Error>(std::move(ok.error()));
    }
    estimate.iterations = found.samples;
    estimate.termination = found.samples < options_.max_iterations ? Termination::kConverged
                                                                   : Termination::kMaxIterations;
    return estimate;
  }

  int LeastInliers() const {
    return std::max(options_.min_inliers, LeastPairs(inner_->spec().needs) + 1);
  }

  static tl::unexpected<Error> NoPose(int samples, int sample_size) {
    return MakeError(ErrorCode::kDegenerate,
                     fmt::format("none of {} samples of {} pairs determines a pose; the points "
                                 "coincide or lie on one line",
                                 samples, sample_size));
  }

  // Of mirrored points, those near one plane agree on a pose, which is not the answer.
  Expected<void> CheckNotMirrored(const CalibrationProblem& problem, const PairTerms& terms) const {
    std::vector<int> all(terms.size());
    std::iota(all.begin(), all.end(), 0);
    const Expected<Estimate> estimate = SolveSubset(*inner_, problem, all);
    if (estimate || estimate.error().code != ErrorCode::kMirrored) return {};
    return tl::unexpected<Error>(estimate.error());
  }

  Expected<Estimate> Finish(const CalibrationProblem& problem, const PairTerms& terms,
                            const PoseScorer& scorer, const Rigid3d& pose) const {
    if (options_.refit == Refit::kNone) return LeastSquaresOnInliers(terms, scorer, pose);
    if (options_.local_optimisation == 0) return RefitOnInliers(*inner_, problem, scorer, pose);
    return BetterOnInliers(*inner_, problem, terms, scorer, pose);
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
        const Expected<RansacOptions> options = RansacOptionSet().Parse(arguments.options);
        if (!options) return tl::unexpected<Error>(options.error());
        const Expected<PairKind> kind = KindOfPairs(*arguments.inner, "ransac");
        if (!kind) return tl::unexpected<Error>(kind.error());
        const int least = LeastPairs(arguments.inner->spec().needs);
        if (options->sample_size > 0 && options->sample_size < least) {
          return MakeError(ErrorCode::kInvalidOption,
                           fmt::format("option sample_size={}: '{}' needs at least {} pairs",
                                       options->sample_size, arguments.inner->spec().name, least));
        }
        return std::make_shared<RansacSolver>(arguments, *kind, *options);
      },
  };
}

}  // namespace sextant
