// SPDX-License-Identifier: Apache-2.0
#include "solvers/robust/consensus.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/log_choose.h"
#include "solvers/core/subset.h"
#include "solvers/robust/term_scorer.h"

namespace sextant {
namespace {

constexpr double kMaxFalseAlarms = 0.01;
constexpr int kMaxConsensusRefits = 10;
// Quantiles at 0.99 of chi-square with 2 and 3 degrees of freedom, and at 0.9999 with 3.
constexpr double kChiSquare2 = 9.210340371976184;
constexpr double kChiSquare3 = 11.344866730144373;
constexpr double kChiSquare3At9999 = 21.107513466204896;

// P(Binomial(trials, p) >= successes).
double BinomialTail(int trials, int successes, double p) {
  if (successes <= 0 || p >= 1.0) return 1.0;
  double log_choose = LogChoose(trials, successes);
  double tail = 0.0;
  for (int k = successes; k <= trials; ++k) {
    const double term = std::exp(log_choose + k * std::log(p) + (trials - k) * std::log1p(-p));
    tail += term;
    // Beyond the mean the terms fall ever faster.
    if (k > trials * p && term < 1e-17 * tail) break;
    if (k < trials) log_choose += std::log((trials - k) / (k + 1.0));
  }
  return tail;
}

// The expected number of poses that `distinct` of `count` pairs agree on by chance.
double FalseAlarms(PairKind kind, int distinct, int count, double chance) {
  const int absorbed = kind == PairKind::k3d3d ? 2 : 3;
  return std::exp(LogChoose(count, std::min(absorbed, count))) *
         BinomialTail(count - absorbed, distinct - absorbed, chance);
}

// Whether `inner` can work on so few pairs.
Expected<void> CheckEnough(const Solver& inner, std::size_t inlier_count) {
  const int min_pairs = MinPairs(inner.spec().needs);
  if (inlier_count >= static_cast<std::size_t>(min_pairs)) return {};
  return MakeError(ErrorCode::kNoConsensus,
                   fmt::format("{} pairs agree on a pose, expected at least {}; check the pairing "
                               "and the sigmas",
                               inlier_count, min_pairs));
}

}  // namespace

double InlierOptions::MaxSquared(PairKind kind) const {
  if (threshold > 0.0) return threshold * threshold;
  return kind == PairKind::k3d3d ? kChiSquare3 : kChiSquare2;
}

double InlierOptions::FinalMaxSquared(const PairScorer& scorer) const {
  constexpr double kMaxFalsePairs = 0.05;
  if (scorer.kind() == PairKind::k2d3d || threshold > 0.0) return MaxSquared(scorer.kind());
  const bool is_safe =
      static_cast<double>(scorer.size()) * scorer.RandomAgreementProbability(kChiSquare3At9999) <
      kMaxFalsePairs;
  return is_safe ? kChiSquare3At9999 : MaxSquared(PairKind::k3d3d);
}

int MinPairs(const DataNeeds& needs) { return std::max(needs.pairs_3d3d, needs.pairs_2d3d); }

DataNeeds NeedsOfConsensus(DataNeeds inner, PairKind kind) {
  ++(kind == PairKind::k3d3d ? inner.pairs_3d3d : inner.pairs_2d3d);
  return inner;
}

Expected<void> CheckConsensus(const PairScorer& scorer, double max_squared,
                              std::span<const int> inliers, int min_inliers) {
  const int distinct = scorer.CountDistinct(inliers);
  const int count = static_cast<int>(scorer.size());
  const double false_alarms =
      FalseAlarms(scorer.kind(), distinct, count, scorer.RandomAgreementProbability(max_squared));
  if (distinct >= min_inliers && false_alarms < kMaxFalseAlarms) return {};
  return MakeError(
      ErrorCode::kNoConsensus,
      fmt::format(
          "the best pose gathers {} of {} pairs (each counted once), expected at least {} "
          "and more than chance explains ({:.2g} such poses, fewer than {:g} wanted); check "
          "the pairing and the sigmas",
          distinct, count, min_inliers, false_alarms, kMaxFalseAlarms));
}

Expected<void> CheckConsensus(const PairScorer& scorer, const Rigid3d& pose, double max_squared,
                              std::span<const int> inliers, int min_inliers) {
  const Expected<void> within_limit = CheckConsensus(scorer, max_squared, inliers, min_inliers);
  const int distinct = scorer.CountDistinct(inliers);
  if (within_limit || distinct < min_inliers) return within_limit;
  std::vector<double> squared(scorer.size());
  scorer.SquaredResiduals(pose, squared);
  double largest = 0.0;
  for (const int i : inliers) largest = std::max(largest, squared[static_cast<std::size_t>(i)]);
  const auto count = static_cast<int>(scorer.size());
  const double chance = scorer.RandomAgreementProbability(largest);
  if (count * FalseAlarms(scorer.kind(), distinct, count, chance) < kMaxFalseAlarms) return {};
  return within_limit;
}

double WantedSamples(std::size_t count, std::size_t inliers, int sample_size, double confidence) {
  const auto n = static_cast<double>(count);
  double all_inliers = 1.0;
  for (int drawn = 0; drawn < sample_size; ++drawn) {
    all_inliers *= std::max(0.0, static_cast<double>(inliers) - drawn) / (n - drawn);
  }
  if (all_inliers >= 1.0) return 1.0;
  return std::ceil(std::log1p(-confidence) / std::log1p(-all_inliers));
}

Expected<Estimate> SolveWhole(const Solver& inner, const CalibrationProblem& problem) {
  SEXTANT_ASSIGN_OR_RETURN(SolveReport report, inner.Solve(problem));
  Estimate estimate = std::move(static_cast<Estimate&>(report));
  estimate.stages.push_back(
      {report.solver, report.cam_from_lidar, report.iterations, report.wall_time_us});
  return estimate;
}

Expected<Estimate> SolveSubset(const Solver& inner, const CalibrationProblem& problem,
                               std::span<const int> indices) {
  Expected<Estimate> estimate = SolveWhole(inner, SubsetOf(problem, inner.spec().needs, indices));
  if (!estimate) return estimate;
  for (int& i : estimate->inliers) i = indices[static_cast<std::size_t>(i)];
  return estimate;
}

Expected<Rigid3d> PoseOfSubset(const Solver& inner, const CalibrationProblem& problem,
                               const PairScorer& scorer, std::span<const int> indices) {
  std::vector<Rigid3d> poses;
  inner.Hypothesize(problem, indices, poses);
  if (poses.empty()) {
    return SolveSubset(inner, problem, indices).map([](const Estimate& e) {
      return e.cam_from_lidar;
    });
  }
  if (poses.size() == 1) return poses.front();
  const TermScorer subset(scorer.Terms(indices));
  const auto squares = [&subset](const Rigid3d& pose) {
    return subset.Cost(pose, std::numeric_limits<double>::max());
  };
  return *std::min_element(poses.begin(), poses.end(), [&](const Rigid3d& a, const Rigid3d& b) {
    return squares(a) < squares(b);
  });
}

Rigid3d OptimiseOnInliers(PairScorer& scorer, const Rigid3d& pose, double max_squared, int rounds,
                          const RefineLimits& limits) {
  Rigid3d best = pose;
  double best_cost = scorer.Cost(pose, max_squared);
  Rigid3d current = pose;
  double widening = 4.0;
  for (int round = 0; round < rounds; ++round) {
    const std::optional<Rigid3d> next = scorer.FitInliers(current, widening * max_squared, limits);
    if (!next) break;
    current = *next;
    const double cost = scorer.CostUpTo(current, max_squared, best_cost);
    const bool falls = current.IsFinite() && cost < best_cost;
    if (falls) {
      best = current;
      best_cost = cost;
    }
    if (widening == 1.0 && !falls) break;
    widening = std::max(1.0, 0.5 * widening);
  }
  return best;
}

Expected<Estimate> RefitOnInliers(const Solver& inner, const CalibrationProblem& problem,
                                  const PairScorer& scorer, const Rigid3d& pose,
                                  double max_squared) {
  std::vector<int> inliers;
  std::vector<int> next;
  scorer.Inliers(pose, max_squared, inliers);
  for (int refit = 0;; ++refit) {
    SEXTANT_RETURN_IF_ERROR(CheckEnough(inner, inliers.size()));
    Expected<Estimate> estimate = SolveSubset(inner, problem, inliers);
    if (!estimate) return estimate;
    scorer.Inliers(estimate->cam_from_lidar, max_squared, next);
    if (next == inliers || refit + 1 == kMaxConsensusRefits) return estimate;
    std::swap(inliers, next);
  }
}

Estimate LeastSquaresOnInliers(const PairScorer& scorer, const Rigid3d& pose, double max_squared) {
  Estimate estimate;
  estimate.cam_from_lidar = pose;
  scorer.Inliers(pose, max_squared, estimate.inliers);
  const PairTerms inliers = scorer.Terms(estimate.inliers);
  const RefinedPose there = RefinePose(inliers.View(), pose, {.max_iterations = 1});
  estimate.covariance = LeastSquaresCovariance(inliers, there.information, there.cost);
  return estimate;
}

Expected<Estimate> BetterOnInliers(const Solver& inner, const CalibrationProblem& problem,
                                   PairScorer& scorer, const Rigid3d& pose, double max_squared) {
  if (!inner.spec().estimates_rotation) {
    return RefitOnInliers(inner, problem, scorer, pose, max_squared);
  }
  constexpr double kRounding = 1e-9;
  std::vector<int> inliers;
  scorer.Inliers(pose, max_squared, inliers);
  SEXTANT_RETURN_IF_ERROR(CheckEnough(inner, inliers.size()));
  const Expected<Rigid3d> refit = PoseOfSubset(inner, problem, scorer, inliers);
  if (refit &&
      scorer.Cost(*refit, max_squared) <= (1.0 + kRounding) * scorer.Cost(pose, max_squared)) {
    return RefitOnInliers(inner, problem, scorer, pose, max_squared);
  }
  const std::optional<Rigid3d> fit = scorer.FitInliers(pose, max_squared, {});
  return LeastSquaresOnInliers(scorer, fit && fit->IsFinite() ? *fit : pose, max_squared);
}

}  // namespace sextant
