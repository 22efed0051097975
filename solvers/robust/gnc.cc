// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <vector>

#include "solvers/core/inner_solver.h"
#include "solvers/core/registry.h"
#include "solvers/robust/consensus.h"
#include "solvers/robust/noise_scale.h"
#include "solvers/robust/term_scorer.h"

namespace sextant {
namespace {

struct GncOptions : InlierOptions {
  double mu_factor = 1.4;
  int max_iterations = 200;
};

// Pairs with less of the largest weight are left out: their sigma would be over a thousand times
// that of the best.
constexpr double kMinWeight = 1e-6;
constexpr double kEveryPair = std::numeric_limits<double>::max();

Pair3d3d Weighted(Pair3d3d pair, double weight) {
  if (pair.covariance_in_cam) {
    *pair.covariance_in_cam /= weight;
  } else {
    pair.sigma_m /= std::sqrt(weight);
  }
  return pair;
}

Pair2d3d Weighted(Pair2d3d pair, double weight) {
  pair.sigma_px /= std::sqrt(weight);
  return pair;
}

template <class Pair>
std::vector<Pair> WeightedPairs(const std::vector<Pair>& pairs,
                                const std::vector<double>& weights) {
  // Least squares depends on the ratios of the weights only.
  const double largest = *std::max_element(weights.begin(), weights.end());
  std::vector<Pair> weighted;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double weight = weights[i] / largest;
    if (weight >= kMinWeight) weighted.push_back(Weighted(pairs[i], weight));
  }
  return weighted;
}

/// Graduated non-convexity with truncated least squares (Yang, Antonante, Tzoumas and Carlone
/// 2020, RA-L 5): min sum_i min(r_i^2, threshold^2), reached from a convex surrogate that
/// approaches the truncated cost as mu grows by a factor of mu_factor in each step.
///
/// 3D-3D pairs with isotropic noise have a closed form of weighted least squares. Otherwise the
/// inner solver gets the weights as sigma / sqrt(w), and weighted least squares starts from its
/// answer, since not every closed form uses the sigmas. At the end the inner solver gets the
/// inliers, within FinalMaxSquared of the options, with their true sigmas. Errors: kNoConsensus
/// (see CheckConsensus), those of the inner solver.
class GncSolver final : public Solver {
 public:
  GncSolver(const SolverArguments& arguments, PairKind kind, const GncOptions& options)
      : Solver({.name = arguments.name,
                .needs = NeedsOfConsensus(arguments.inner->spec().needs, kind),
                .estimates_rotation = arguments.inner->spec().estimates_rotation,
                .is_global = arguments.inner->spec().is_global}),
        inner_(arguments.inner),
        kind_(kind),
        options_(options) {}

 private:
  Expected<Estimate> DoSolve(const CalibrationProblem& problem) const override {
    return SolveWithNoise(problem, kind_, options_, *inner_, kScaleSeed,
                          [this](const CalibrationProblem& stated) { return SolveStated(stated); });
  }

  // Requires pairs that state their noise.
  Expected<Estimate> SolveStated(const CalibrationProblem& problem) const {
    const double max_squared = options_.MaxSquared(kind_);
    const std::unique_ptr<PairScorer> scorer = MakePairScorer(problem, kind_);
    int iterations = 0;
    SEXTANT_ASSIGN_OR_RETURN(const Rigid3d pose, Anneal(problem, *scorer, max_squared, iterations));
    Expected<Estimate> estimate =
        BetterOnInliers(*inner_, problem, *scorer, pose, options_.FinalMaxSquared(*scorer));
    if (!estimate) return estimate;
    SEXTANT_RETURN_IF_ERROR(CheckConsensus(*scorer, estimate->cam_from_lidar, max_squared,
                                           estimate->inliers, MinPairs(spec().needs)));
    estimate->iterations = iterations;
    estimate->termination = iterations < options_.max_iterations ? Termination::kConverged
                                                                 : Termination::kMaxIterations;
    return estimate;
  }

  Expected<Rigid3d> Anneal(const CalibrationProblem& problem, PairScorer& scorer,
                           double max_squared, int& iterations) const {
    // Weights that are no further than this from 0 or 1, and from what they were, are settled, once
    // there are weights of 1: where the largest residual is a thousand times the threshold, all
    // start near 0.
    constexpr double kSettled = 1e-3;
    SEXTANT_ASSIGN_OR_RETURN(Rigid3d pose, FirstFit(problem, scorer));
    iterations = 1;
    const double largest = scorer.LargestSquared(pose);
    if (largest <= max_squared) return pose;
    // The surrogate is convex at the largest residual.
    double mu = max_squared / (2.0 * largest - max_squared);
    for (; iterations < options_.max_iterations; ++iterations) {
      const GncReweighting reweighting = scorer.Reweight(pose, GncWeight(max_squared, mu));
      if (mu >= 1.0 && reweighting.unsettled < kSettled) break;
      if (reweighting.fit && spec().estimates_rotation) {
        pose = *reweighting.fit;
      } else {
        SEXTANT_ASSIGN_OR_RETURN(pose, FitWeighted(problem, scorer.Weights(), pose));
      }
      mu *= options_.mu_factor;
    }
    return pose;
  }

  // Least squares on all pairs. Where outliers leave the inner solver no pose of all of them, it
  // starts from the pose that more pairs agree on than chance explains.
  Expected<Rigid3d> FirstFit(const CalibrationProblem& problem, PairScorer& scorer) const {
    Expected<Rigid3d> pose = FitAll(problem, scorer, std::nullopt);
    if (pose || pose.error().code != ErrorCode::kNoConsensus) return pose;
    const Expected<Rigid3d> start = FindConsensusPose(problem, kind_, *inner_);
    if (!start) return pose;
    return FitAll(problem, scorer, *start);
  }

  // Least squares from the pose of the inner solver, or from `before` if that costs less or the
  // inner solver has none.
  Expected<Rigid3d> FitAll(const CalibrationProblem& problem, PairScorer& scorer,
                           const std::optional<Rigid3d>& before) const {
    std::vector<int> all(scorer.size());
    std::iota(all.begin(), all.end(), 0);
    Expected<Rigid3d> pose = PoseOfSubset(*inner_, problem, scorer, all);
    if ((!pose && !before) || !spec().estimates_rotation) return pose;
    const bool is_better =
        !before || (pose && scorer.Cost(*pose, kEveryPair) <= scorer.Cost(*before, kEveryPair));
    const Rigid3d& start = is_better ? *pose : *before;
    // Points behind the camera, which an outlier may cause, are left out.
    return scorer.FitInliers(start, kEveryPair, {}).value_or(start);
  }

  Expected<Rigid3d> FitWeighted(const CalibrationProblem& problem,
                                const std::vector<double>& weights, const Rigid3d& before) const {
    CalibrationProblem weighted;
    weighted.camera = problem.camera;
    weighted.initial_cam_from_lidar = problem.initial_cam_from_lidar;
    weighted.boards = problem.boards;
    if (kind_ == PairKind::k3d3d) {
      weighted.pairs_3d3d = WeightedPairs(problem.pairs_3d3d, weights);
    } else {
      weighted.pairs_2d3d = WeightedPairs(problem.pairs_2d3d, weights);
    }
    TermScorer scorer(MakeTerms(weighted, kind_));
    const int min_pairs = MinPairs(inner_->spec().needs);
    if (scorer.size() < static_cast<std::size_t>(min_pairs)) {
      return MakeError(ErrorCode::kNoConsensus,
                       fmt::format("{} of {} pairs keep a weight, expected at least {}; check the "
                                   "pairing and the sigmas",
                                   scorer.size(), weights.size(), min_pairs));
    }
    return FitAll(weighted, scorer, before);
  }

  SolverPtr inner_;
  PairKind kind_;
  GncOptions options_;
};

OptionSet<GncOptions> GncOptionSet() {
  OptionSet<GncOptions> options;
  options
      .Real("mu_factor", &GncOptions::mu_factor, "1", 1.01, 10.0,
            "factor by which the cost becomes less convex in each iteration")
      .Count("max_iterations", &GncOptions::max_iterations, 1, 100'000,
             "maximum number of weighted fits");
  return AddInlierOptions(options);
}

}  // namespace

SolverEntry GncEntry() {
  return {
      .name = "gnc",
      .summary = "truncated least squares by graduated non-convexity: outliers fade out by weight",
      .needs = "what the inner solver needs and at least one pair more; up to 80 percent outliers",
      .reference = "Yang, Antonante, Tzoumas and Carlone 2020",
      .example = "gnc(kabsch)",
      .wraps_solver = true,
      .options = GncOptionSet().Describe(),
      .make = [](const SolverArguments& arguments) -> Expected<SolverPtr> {
        SEXTANT_ASSIGN_OR_RETURN(const GncOptions options, GncOptionSet().Parse(arguments.options));
        SEXTANT_ASSIGN_OR_RETURN(const PairKind kind, KindOfPairs(*arguments.inner, "gnc"));
        return std::make_shared<GncSolver>(arguments, kind, options);
      },
  };
}

}  // namespace sextant
