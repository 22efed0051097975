// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "solvers/core/inner_solver.h"
#include "solvers/core/registry.h"
#include "solvers/robust/consensus.h"
#include "solvers/robust/noise_scale.h"
#include "solvers/robust/term_scorer.h"

namespace sextant {
namespace {

struct DropWorstOptions : InlierOptions {
  int keep = 0;
};

// One of so many pairs is dropped at a time, so that up to 199 are dropped one by one.
constexpr std::size_t kPairsPerDropped = 100;

/// Solves, removes the pair with the largest residual, and solves again: the paper's elimination
/// by hand (20 points, then 11, then 8) as a method. Of 200 pairs and more the worst hundredth is
/// removed at once.
///
/// Ends with `keep` pairs and the inner solver on these; with keep=0 as soon as all remaining pairs
/// are within the threshold. These must be a consensus (see CheckConsensus); where outliers spoil
/// the fits so that true pairs are dropped and none is left, those near the pose of
/// FindConsensusPose must. The answer is that of BetterOnInliers. Residuals are in sigmas, so that
/// a pair that is known to be noisy is not dropped for it. At most 200 + 100 log(pairs / 100)
/// solutions of the inner solver. Errors: kNoConsensus, kTooFewPairs (fewer than `keep`), those of
/// the inner solver.
class DropWorstSolver final : public Solver {
 public:
  DropWorstSolver(const SolverArguments& arguments, PairKind kind, const DropWorstOptions& options)
      : Solver({.name = arguments.name,
                .needs = WithKept(arguments.inner->spec().needs, kind, options.keep),
                .estimates_rotation = arguments.inner->spec().estimates_rotation,
                .is_global = arguments.inner->spec().is_global}),
        inner_(arguments.inner),
        kind_(kind),
        options_(options) {}

 private:
  static DataNeeds WithKept(const DataNeeds& inner, PairKind kind, int keep) {
    DataNeeds needs = NeedsOfConsensus(inner, kind);
    if (keep > 0) (kind == PairKind::k3d3d ? needs.pairs_3d3d : needs.pairs_2d3d) = keep;
    return needs;
  }

  Expected<Estimate> DoSolve(const CalibrationProblem& problem) const override {
    // Without a threshold the noise does not matter.
    if (options_.keep > 0) return SolveStated(problem);
    return SolveWithNoise(problem, kind_, options_, *inner_, kScaleSeed,
                          [this](const CalibrationProblem& stated) { return SolveStated(stated); });
  }

  // Requires pairs that state their noise, or keep.
  Expected<Estimate> SolveStated(const CalibrationProblem& problem) const {
    Expected<Estimate> estimate = Eliminate(problem);
    const bool is_spoilt = !estimate && estimate.error().code == ErrorCode::kNoConsensus;
    if (!is_spoilt || options_.keep > 0) return estimate;
    Expected<Estimate> near = NearConsensus(problem);
    return near ? near : estimate;
  }

  Expected<Estimate> NearConsensus(const CalibrationProblem& problem) const {
    const double max_squared = options_.MaxSquared(kind_);
    SEXTANT_ASSIGN_OR_RETURN(const Rigid3d pose, FindConsensusPose(problem, kind_, *inner_));
    TermScorer scorer(MakeTerms(problem, kind_));
    Expected<Estimate> estimate = AnswerNear(problem, scorer, pose, max_squared);
    if (!estimate) return estimate;
    SEXTANT_RETURN_IF_ERROR(
        CheckConsensus(scorer, max_squared, estimate->inliers, MinPairs(spec().needs)));
    estimate->iterations = 1;
    estimate->termination = Termination::kConverged;
    return estimate;
  }

  Expected<Estimate> Eliminate(const CalibrationProblem& problem) const {
    const double max_squared = options_.MaxSquared(kind_);
    TermScorer scorer(MakeTerms(problem, kind_));
    std::vector<double> squared(scorer.size());
    std::vector<int> kept(scorer.size());
    std::iota(kept.begin(), kept.end(), 0);
    const int min_kept = options_.keep > 0 ? options_.keep : MinPairs(inner_->spec().needs);
    bool all_within = false;
    int solves = 0;
    Rigid3d pose;
    while (true) {
      ++solves;
      SEXTANT_ASSIGN_OR_RETURN(pose, PoseOfSubset(*inner_, problem, scorer, kept));
      scorer.SquaredResiduals(pose, squared);
      const auto beyond = std::ranges::count_if(
          kept, [&](int i) { return !(squared[static_cast<std::size_t>(i)] <= max_squared); });
      all_within = beyond == 0;
      auto most = std::ssize(kept) - min_kept;
      if (options_.keep == 0) most = std::min<std::ptrdiff_t>(most, beyond);
      if (most <= 0) break;
      const auto share = static_cast<std::ptrdiff_t>(kept.size() / kPairsPerDropped);
      Drop(std::min(most, std::max<std::ptrdiff_t>(1, share)), squared, kept);
    }
    if (options_.keep == 0) {
      const std::span<const int> agreeing = all_within ? kept : std::span<const int>();
      SEXTANT_RETURN_IF_ERROR(
          CheckConsensus(scorer, max_squared, agreeing, MinPairs(spec().needs)));
    }
    Expected<Estimate> estimate = options_.keep > 0
                                      ? SolveSubset(*inner_, problem, kept)
                                      : AnswerNear(problem, scorer, pose, max_squared);
    if (!estimate) return estimate;
    estimate->iterations = solves;
    estimate->termination = Termination::kConverged;
    return estimate;
  }

  // Removes so many with the largest residuals; the others stay in their order.
  static void Drop(std::ptrdiff_t count, const std::vector<double>& squared,
                   std::vector<int>& kept) {
    const auto residual = [&](int i) {
      const double value = squared[static_cast<std::size_t>(i)];
      return std::isnan(value) ? std::numeric_limits<double>::infinity() : value;
    };
    std::vector<int> worst = kept;
    std::ranges::nth_element(worst, worst.begin() + count - 1, [&](int a, int b) {
      return std::pair(-residual(a), a) < std::pair(-residual(b), b);
    });
    worst.resize(static_cast<std::size_t>(count));
    std::ranges::sort(worst);
    std::erase_if(kept, [&](int i) { return std::ranges::binary_search(worst, i); });
  }

  // As ransac and gnc: an algebraic inner solver weighs the pairs by their depth, so that the one
  // noise of all pairs is not that of its answer.
  Expected<Estimate> AnswerNear(const CalibrationProblem& problem, TermScorer& scorer,
                                const Rigid3d& pose, double max_squared) const {
    const std::optional<Rigid3d> fit = spec().estimates_rotation
                                           ? scorer.FitInliers(pose, max_squared, {})
                                           : std::optional<Rigid3d>();
    return BetterOnInliers(*inner_, problem, scorer, fit && fit->IsFinite() ? *fit : pose,
                           max_squared);
  }

  SolverPtr inner_;
  PairKind kind_;
  DropWorstOptions options_;
};

OptionSet<DropWorstOptions> DropWorstOptionSet() {
  OptionSet<DropWorstOptions> options;
  options.Count("keep", &DropWorstOptions::keep, 0, 1'000'000'000,
                "pairs left at the end; 0: as many as are within the threshold");
  return AddInlierOptions(options);
}

}  // namespace

SolverEntry DropWorstEntry() {
  return {
      .name = "drop_worst",
      .summary =
          "removes the worst pair (of 200 or more 1 percent) and solves again, until keep are left",
      .needs = "keep pairs, or what the inner solver needs and at least one pair more",
      .reference = "the manual elimination of the paper (20 to 11 to 8 points)",
      .example = "drop_worst(kabsch)",
      .wraps_solver = true,
      .options = DropWorstOptionSet().Describe(),
      .make = [](const SolverArguments& arguments) -> Expected<SolverPtr> {
        SEXTANT_ASSIGN_OR_RETURN(const DropWorstOptions options,
                                 DropWorstOptionSet().Parse(arguments.options));
        SEXTANT_ASSIGN_OR_RETURN(const PairKind kind, KindOfPairs(*arguments.inner, "drop_worst"));
        const int min_pairs = MinPairs(arguments.inner->spec().needs);
        if (options.keep > 0 && options.keep < min_pairs) {
          return MakeError(ErrorCode::kInvalidOption,
                           fmt::format("option keep={}: '{}' needs at least {} pairs", options.keep,
                                       arguments.inner->spec().name, min_pairs));
        }
        return std::make_shared<DropWorstSolver>(arguments, kind, options);
      },
  };
}

}  // namespace sextant
