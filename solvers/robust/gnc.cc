// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "solvers/core/inner_solver.h"
#include "solvers/core/registry.h"
#include "solvers/kernels/gnc_columns.h"
#include "solvers/least_squares/refine_pose.h"
#include "solvers/robust/consensus.h"
#include "solvers/robust/pair_scorer.h"

namespace sextant {
namespace {

struct GncOptions : InlierOptions {
  double mu_factor = 1.4;
  int max_iterations = 200;
};

// Pairs of less weight are left out: their sigma would be over a thousand times the stated one.
constexpr double kMinWeight = 1e-6;
constexpr double kEveryPair = std::numeric_limits<double>::max();

double Weight(double squared, const GncWeight& by) {
  if (squared <= by.full) return 1.0;
  if (!(squared < by.none)) return 0.0;
  return std::sqrt(by.scale / squared) - by.mu;
}

Pair3d3d Weighted(Pair3d3d pair, double weight, const AssumedNoise& assumed) {
  if (pair.covariance_in_cam) {
    *pair.covariance_in_cam /= weight;
  } else {
    pair.sigma_m = (pair.sigma_m > 0.0 ? pair.sigma_m : assumed.sigma_m) / std::sqrt(weight);
  }
  return pair;
}

Pair2d3d Weighted(Pair2d3d pair, double weight, const AssumedNoise& assumed) {
  pair.sigma_px = (pair.sigma_px > 0.0 ? pair.sigma_px : assumed.sigma_px) / std::sqrt(weight);
  return pair;
}

template <class Pair>
std::vector<Pair> WeightedPairs(const std::vector<Pair>& pairs, const std::vector<double>& weights,
                                const AssumedNoise& assumed) {
  std::vector<Pair> weighted;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (weights[i] >= kMinWeight) weighted.push_back(Weighted(pairs[i], weights[i], assumed));
  }
  return weighted;
}

/// Graduated non-convexity with truncated least squares (Yang, Antonante, Tzoumas and Carlone
/// 2020, RA-L 5): min sum_i min(r_i^2, threshold^2), reached from a convex surrogate that mu
/// bends, a step of mu_factor at a time, towards the truncated cost.
///
/// The weights go to the inner solver as sigma / sqrt(w); weighted least squares from its answer
/// follows, since not every closed form heeds sigmas. At the end the inner solver gets the inliers
/// with their true sigmas. Errors: kNoConsensus (see CheckConsensus), those of the inner solver.
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
    const bool in_columns =
        kind_ == PairKind::k3d3d && spec().estimates_rotation && AreIsotropic(problem.pairs_3d3d);
    if (in_columns) {
      std::optional<Estimate> estimate = SolveInColumns(problem);
      if (estimate) return std::move(*estimate);
    }
    return SolveInTerms(problem);
  }

  // None where that does not answer; the long way then does, or says why not.
  std::optional<Estimate> SolveInColumns(const CalibrationProblem& problem) const {
    const double max_squared = options_.MaxSquared(kind_);
    const PairColumns pairs(problem.pairs_3d3d, options_.Assumed());
    const Expected<Estimate> start = SolveWhole(*inner_, problem);
    if (!start) return std::nullopt;
    const InlierFit of_all = FitInliers(pairs, start->cam_from_lidar, kEveryPair);
    if (!of_all.fitted) return std::nullopt;
    const std::optional<GncPose> annealed = AnnealInColumns(
        pairs, of_all.cam_from_lidar, {max_squared, options_.mu_factor, options_.max_iterations});
    if (!annealed) return std::nullopt;
    std::optional<Estimate> estimate =
        RefitIfNoWorse(*inner_, problem, pairs, annealed->cam_from_lidar, max_squared);
    const int least = MinPairs(spec().needs);
    if (!estimate || !CheckConsensus(pairs, max_squared, estimate->inliers, least)) {
      return std::nullopt;
    }
    SetIterations(annealed->iterations, *estimate);
    return estimate;
  }

  void SetIterations(int iterations, Estimate& estimate) const {
    estimate.iterations = iterations;
    estimate.termination = iterations < options_.max_iterations ? Termination::kConverged
                                                                : Termination::kMaxIterations;
  }

  Expected<Estimate> SolveInTerms(const CalibrationProblem& problem) const {
    const PairTerms terms = MakeTerms(problem, kind_, options_.Assumed());
    const PoseScorer scorer(terms, options_.MaxSquared(kind_));
    int iterations = 0;
    SEXTANT_ASSIGN_OR_RETURN(const Rigid3d pose, Anneal(problem, terms, scorer, iterations));
    Expected<Estimate> estimate = BetterOnInliers(*inner_, problem, terms, scorer, pose);
    if (!estimate) return estimate;
    const int least = MinPairs(spec().needs);
    SEXTANT_RETURN_IF_ERROR(CheckConsensus(terms, scorer, estimate->inliers, least));
    SetIterations(iterations, *estimate);
    return estimate;
  }

  Expected<Rigid3d> Anneal(const CalibrationProblem& problem, const PairTerms& terms,
                           const PoseScorer& scorer, int& iterations) const {
    std::vector<double> weights(terms.size(), 1.0);
    std::vector<double> squared(terms.size());
    Expected<Rigid3d> pose = SolveWeighted(problem, weights, std::nullopt);
    double mu = 0.0;
    for (iterations = 1; pose && iterations < options_.max_iterations; ++iterations) {
      scorer.SquaredResiduals(*pose, squared);
      if (iterations == 1) {
        mu = FirstGncMu(LargestFinite(squared), scorer.max_squared());
        if (mu <= 0.0) break;
      }
      if (!UpdateWeights(squared, GncWeight(scorer.max_squared(), mu), weights)) break;
      pose = SolveWeighted(problem, weights, *pose);
      mu *= options_.mu_factor;
    }
    return pose;
  }

  static double LargestFinite(const std::vector<double>& squared) {
    double largest = 0.0;
    for (const double s : squared) largest = std::isfinite(s) ? std::max(largest, s) : largest;
    return largest;
  }

  // False where every weight was, and is, 0 or 1.
  static bool UpdateWeights(const std::vector<double>& squared, const GncWeight& by,
                            std::vector<double>& weights) {
    bool settled = true;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const double weight = Weight(squared[i], by);
      settled = settled && std::min(weight, 1.0 - weight) < kGncBinary &&
                std::abs(weight - weights[i]) < kGncBinary;
      weights[i] = weight;
    }
    return !settled;
  }

  // The least weighted squares: from the inner solver's pose, or the one before if that is better.
  Expected<Rigid3d> SolveWeighted(const CalibrationProblem& problem,
                                  const std::vector<double>& weights,
                                  const std::optional<Rigid3d>& before) const {
    CalibrationProblem weighted;
    weighted.camera = problem.camera;
    weighted.initial_cam_from_lidar = problem.initial_cam_from_lidar;
    weighted.boards = problem.boards;
    if (kind_ == PairKind::k3d3d) {
      weighted.pairs_3d3d = WeightedPairs(problem.pairs_3d3d, weights, options_.Assumed());
    } else {
      weighted.pairs_2d3d = WeightedPairs(problem.pairs_2d3d, weights, options_.Assumed());
    }
    const PairTerms terms = MakeTerms(weighted, kind_, options_.Assumed());
    const int least = MinPairs(inner_->spec().needs);
    if (terms.size() < static_cast<std::size_t>(least)) {
      return MakeError(ErrorCode::kNoConsensus,
                       fmt::format("{} of {} pairs keep a weight, expected at least {}; check the "
                                   "pairing and the sigmas",
                                   terms.size(), weights.size(), least));
    }
    std::vector<int> all(terms.size());
    std::iota(all.begin(), all.end(), 0);
    Expected<Rigid3d> pose = PoseOfSubset(*inner_, weighted, terms, all);
    if (!pose || !spec().estimates_rotation) return pose;
    const PoseScorer squares(terms, kEveryPair);
    const bool is_better = !before || squares.Cost(*pose) <= squares.Cost(*before);
    const Rigid3d& start = is_better ? *pose : *before;
    // An outlier may put points behind the camera, which least squares cannot begin with.
    std::vector<int> projected;
    squares.Inliers(start, projected);
    PairTerms in_front;
    in_front.AssignSubset(terms, projected);
    return RefinePose(in_front.View(), start, {.wants_information = false}).cam_from_lidar;
  }

  SolverPtr inner_;
  PairKind kind_;
  GncOptions options_;
};

OptionSet<GncOptions> GncOptionSet() {
  OptionSet<GncOptions> options;
  options
      .Real("mu_factor", &GncOptions::mu_factor, "1", 1.01, 10.0,
            "how much less convex the cost becomes each iteration")
      .Count("max_iterations", &GncOptions::max_iterations, 1, 100'000,
             "most times the inner solver is called with weights");
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
