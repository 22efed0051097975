// SPDX-License-Identifier: Apache-2.0
#include "solvers/robust/consensus.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "solvers/alignment/isotropic_points.h"
#include "solvers/core/subset.h"
#include "solvers/robust/shrinking_inliers.h"

namespace sextant {
namespace {

constexpr double kMaxFalseAlarms = 0.01;
constexpr int kMaxConsensusRefits = 10;
// Quantiles at 0.99 of chi-square with 2 and 3 degrees of freedom.
constexpr double kChiSquare2 = 9.210340371976184;
constexpr double kChiSquare3 = 11.344866730144373;

// log of (n over k). By sums: std::lgamma writes a global, which is a data race.
double LogChoose(int n, int k) {
  double sum = 0.0;
  for (int i = 1; i <= std::min(k, n - k); ++i) {
    sum += std::log(static_cast<double>(n - std::min(k, n - k) + i) / i);
  }
  return sum;
}

// P(Binomial(trials, p) >= successes).
double BinomialTail(int trials, int successes, double p) {
  if (successes <= 0 || p >= 1.0) return 1.0;
  double log_choose = LogChoose(trials, successes);
  double tail = 0.0;
  for (int k = successes; k <= trials; ++k) {
    const double term = std::exp(log_choose + k * std::log(p) + (trials - k) * std::log1p(-p));
    tail += term;
    // Beyond the mean each is smaller than the one before, ever faster.
    if (k > trials * p && term < 1e-17 * tail) break;
    if (k < trials) log_choose += std::log((trials - k) / (k + 1.0));
  }
  return tail;
}

// Expected number of poses that so many pairs agree on by chance.
double FalseAlarms(PairKind kind, int distinct, int count, double chance) {
  const int absorbed = kind == PairKind::k3d3d ? 2 : 3;
  return std::exp(LogChoose(count, std::min(absorbed, count))) *
         BinomialTail(count - absorbed, distinct - absorbed, chance);
}

int CountDistinct(const PairTerms& terms, std::span<const int> indices) {
  std::vector<std::array<double, 6>> numbers;
  numbers.reserve(indices.size());
  for (const int i : indices) {
    const auto index = static_cast<std::size_t>(i);
    const bool is_point = terms.pixels.empty();
    const Eigen::Vector3d p =
        is_point ? terms.points[index].in_lidar : terms.pixels[index].in_lidar;
    const Eigen::Vector3d m =
        is_point ? terms.points[index].in_cam : terms.pixels[index].pixel.homogeneous().eval();
    numbers.push_back({p.x(), p.y(), p.z(), m.x(), m.y(), m.z()});
  }
  std::sort(numbers.begin(), numbers.end());
  return static_cast<int>(std::unique(numbers.begin(), numbers.end()) - numbers.begin());
}

// Whether `inner` can work on so few.
Expected<void> CheckEnough(const Solver& inner, std::size_t inlier_count) {
  const int least = MinPairs(inner.spec().needs);
  if (inlier_count >= static_cast<std::size_t>(least)) return {};
  return MakeError(ErrorCode::kNoConsensus,
                   fmt::format("{} pairs agree on a pose, expected at least {}; check the pairing "
                               "and the sigmas",
                               inlier_count, least));
}

}  // namespace

double InlierOptions::MaxSquared(PairKind kind) const {
  if (threshold > 0.0) return threshold * threshold;
  return kind == PairKind::k3d3d ? kChiSquare3 : kChiSquare2;
}

double InlierOptions::FinalMaxSquared(std::size_t count, double chance_at_9999) const {
  constexpr double kMaxFalsePairs = 0.05;
  const bool is_safe = static_cast<double>(count) * chance_at_9999 < kMaxFalsePairs;
  return threshold == 0.0 && is_safe ? kChiSquare3At9999 : MaxSquared(PairKind::k3d3d);
}

int MinPairs(const DataNeeds& needs) { return std::max(needs.pairs_3d3d, needs.pairs_2d3d); }

DataNeeds NeedsOfConsensus(DataNeeds inner, PairKind kind) {
  ++(kind == PairKind::k3d3d ? inner.pairs_3d3d : inner.pairs_2d3d);
  return inner;
}

double RandomAgreementProbability(const PairTerms& terms, double max_squared) {
  const double threshold = std::sqrt(max_squared);
  if (terms.pixels.empty()) {
    Eigen::AlignedBox3d box;
    double radius = 0.0;
    for (const PointTerm& term : terms.points) {
      box.extend(term.in_cam);
      radius += threshold / std::cbrt(std::abs(term.whitener.determinant()));
    }
    radius /= static_cast<double>(terms.points.size());
    return RandomPointProbability(box, radius);
  }
  Eigen::AlignedBox2d box;
  double radius = 0.0;
  for (const PixelTerm term : terms.pixels) {
    box.extend(term.pixel);
    radius += threshold / term.inverse_sigma;
  }
  radius /= static_cast<double>(terms.pixels.size());
  const double disc = std::numbers::pi * radius * radius;
  return std::min(1.0, disc / (box.sizes().array() + 2.0 * radius).prod());
}

double RandomPointProbability(const Eigen::AlignedBox3d& box, double radius) {
  const double ball = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
  return std::min(1.0, ball / (box.sizes().array() + 2.0 * radius).prod());
}

Expected<void> CheckConsensus(PairKind kind, int distinct, int count, double chance, int least) {
  const double false_alarms = FalseAlarms(kind, distinct, count, chance);
  if (distinct >= least && false_alarms < kMaxFalseAlarms) return {};
  return MakeError(
      ErrorCode::kNoConsensus,
      fmt::format("the best pose gathers {} of {} pairs (each counted once), expected at least {} "
                  "and more than chance "
                  "explains ({:.2g} such poses, fewer than {:g} wanted); check the pairing and the "
                  "sigmas",
                  distinct, count, least, false_alarms, kMaxFalseAlarms));
}

Expected<void> CheckConsensus(const PairTerms& terms, const PoseScorer& scorer,
                              std::span<const int> inliers, int least) {
  return CheckConsensus(terms.pixels.empty() ? PairKind::k3d3d : PairKind::k2d3d,
                        CountDistinct(terms, inliers), static_cast<int>(terms.size()),
                        RandomAgreementProbability(terms, scorer.max_squared()), least);
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
                               const PairTerms& terms, std::span<const int> indices) {
  std::vector<Rigid3d> poses;
  inner.Hypothesize(problem, indices, poses);
  if (poses.empty()) {
    return SolveSubset(inner, problem, indices).map([](const Estimate& e) {
      return e.cam_from_lidar;
    });
  }
  if (poses.size() == 1) return poses.front();
  PairTerms subset;
  subset.AssignSubset(terms, indices);
  const PoseScorer squares(subset, std::numeric_limits<double>::max());
  return *std::min_element(poses.begin(), poses.end(), [&](const Rigid3d& a, const Rigid3d& b) {
    return squares.Cost(a) < squares.Cost(b);
  });
}

Expected<Estimate> RefitOnInliers(const Solver& inner, const CalibrationProblem& problem,
                                  const FindInliers& find_inliers, const Rigid3d& pose) {
  std::vector<int> inliers;
  std::vector<int> next;
  find_inliers(pose, inliers);
  for (int refit = 0;; ++refit) {
    SEXTANT_RETURN_IF_ERROR(CheckEnough(inner, inliers.size()));
    Expected<Estimate> estimate = SolveSubset(inner, problem, inliers);
    if (!estimate) return estimate;
    find_inliers(estimate->cam_from_lidar, next);
    if (next == inliers || refit + 1 == kMaxConsensusRefits) return estimate;
    std::swap(inliers, next);
  }
}

Expected<Estimate> RefitOnInliers(const Solver& inner, const CalibrationProblem& problem,
                                  const PoseScorer& scorer, const Rigid3d& pose) {
  const auto by_scorer = [&scorer](const Rigid3d& at, std::vector<int>& inliers) {
    scorer.Inliers(at, inliers);
  };
  return RefitOnInliers(inner, problem, by_scorer, pose);
}

Rigid3d OptimiseOnInliers(const PairTerms& terms, const PoseScorer& scorer, const Rigid3d& pose,
                          int rounds, const RefineLimits& limits, InlierWorkspace& workspace) {
  const std::size_t least = terms.pixels.empty() ? 3 : 4;
  RefineLimits of_pose = limits;
  of_pose.wants_information = false;
  return OptimiseOnShrinkingInliers(
      pose, scorer.Cost(pose), rounds,
      [&](const Rigid3d& at, double most) { return scorer.Cost(at, most); },
      [&](const Rigid3d& at, double widening) -> std::optional<Rigid3d> {
        scorer.Inliers(at, workspace.inliers, widening);
        if (workspace.inliers.size() < least) return std::nullopt;
        workspace.terms.AssignSubset(terms, workspace.inliers);
        std::optional<Rigid3d> closed_form =
            FitIsotropicPoints(workspace.terms.points, workspace.buffers);
        if (closed_form) return closed_form;
        return RefinePose(workspace.terms.View(), at, of_pose).cam_from_lidar;
      });
}

Estimate LeastSquaresOnInliers(const PairTerms& terms, const PoseScorer& scorer,
                               const Rigid3d& pose) {
  Estimate estimate;
  estimate.cam_from_lidar = pose;
  scorer.Inliers(pose, estimate.inliers);
  PairTerms inliers;
  inliers.AssignSubset(terms, estimate.inliers);
  const RefinedPose there = RefinePose(inliers.View(), pose, {.max_iterations = 1});
  estimate.covariance = LeastSquaresCovariance(inliers, there.information, there.cost);
  return estimate;
}

Expected<Estimate> BetterOnInliers(const Solver& inner, const CalibrationProblem& problem,
                                   const PairTerms& terms, const PoseScorer& scorer,
                                   const Rigid3d& pose) {
  if (!inner.spec().estimates_rotation) return RefitOnInliers(inner, problem, scorer, pose);
  constexpr double kRounding = 1e-9;
  std::vector<int> inliers;
  scorer.Inliers(pose, inliers);
  SEXTANT_RETURN_IF_ERROR(CheckEnough(inner, inliers.size()));
  const Expected<Rigid3d> refit = PoseOfSubset(inner, problem, terms, inliers);
  if (refit && scorer.Cost(*refit) <= (1.0 + kRounding) * scorer.Cost(pose)) {
    return RefitOnInliers(inner, problem, scorer, pose);
  }
  return LeastSquaresOnInliers(terms, scorer, pose);
}

}  // namespace sextant
