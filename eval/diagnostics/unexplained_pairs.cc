// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/unexplained_pairs.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace sextant {
namespace {

struct Misfit {
  double residual = 0.0;  ///< RMS, in the unit of the points.
  double spread = 0.0;    ///< RMS distance from their mean.
};

template <int kSize>
std::optional<Misfit> MisfitOf(const std::vector<Eigen::Matrix<double, kSize, 1>>& points,
                               std::span<const double> residuals, const std::vector<int>& used) {
  constexpr std::size_t kMinPairs = 4;
  if (used.size() < kMinPairs || residuals.size() != points.size()) return std::nullopt;
  Eigen::Matrix<double, kSize, 1> mean = Eigen::Matrix<double, kSize, 1>::Zero();
  for (const int i : used) mean += points[static_cast<std::size_t>(i)];
  mean /= static_cast<double>(used.size());
  double spread = 0.0;
  double unexplained = 0.0;
  for (const int i : used) {
    const auto index = static_cast<std::size_t>(i);
    spread += (points[index] - mean).squaredNorm();
    unexplained += residuals[index] * residuals[index];
  }
  if (!(spread > 0.0)) return std::nullopt;
  const auto count = static_cast<double>(used.size());
  return Misfit{std::sqrt(unexplained / count), std::sqrt(spread / count)};
}

}  // namespace

std::optional<double> UnexplainedShare(const CalibrationProblem& problem,
                                       const SolveReport& report) {
  if (problem.pairs_3d3d.empty() == problem.pairs_2d3d.empty()) return std::nullopt;
  if (problem.pairs_2d3d.empty()) {
    std::vector<Eigen::Vector3d> points;
    for (const Pair3d3d& pair : problem.pairs_3d3d) points.push_back(pair.point_in_cam);
    const auto misfit = MisfitOf<3>(points, report.evaluation.per_pair_m, report.inliers);
    if (!misfit) return std::nullopt;
    return misfit->residual / misfit->spread;
  }
  std::vector<Eigen::Vector2d> pixels;
  for (const Pair2d3d& pair : problem.pairs_2d3d) pixels.push_back(pair.pixel);
  const auto misfit = MisfitOf<2>(pixels, report.evaluation.per_pair_px, report.inliers);
  if (!misfit) return std::nullopt;
  constexpr double kMaxSpread = 0.2;
  constexpr double kUnknowns = 6.0;
  const double numbers = 2.0 * static_cast<double>(report.inliers.size());
  const double noise_px = misfit->residual * std::sqrt(numbers / (numbers - kUnknowns));
  const double focal_px = problem.camera ? problem.camera->fx_px : misfit->spread / kMaxSpread;
  return noise_px / std::min(misfit->spread, kMaxSpread * focal_px);
}

std::optional<std::string> DescribeMisfit(const CalibrationProblem& problem,
                                          const SolveReport& report) {
  constexpr double kUsual = 0.2;
  const bool is_stated = std::any_of(problem.pairs_3d3d.begin(), problem.pairs_3d3d.end(),
                                     [](const Pair3d3d& pair) { return HasKnownNoise(pair); }) ||
                         std::any_of(problem.pairs_2d3d.begin(), problem.pairs_2d3d.end(),
                                     [](const Pair2d3d& pair) { return HasKnownNoise(pair); });
  const std::optional<double> share = UnexplainedShare(problem, report);
  if (is_stated || !share || *share < kUsual) return std::nullopt;
  return fmt::format(
      "misfit: the residuals are {:.0f} percent of the spread of the measurements (of 11 deg at "
      "most), where {:.0f} or less is usual, so that the stated uncertainty, which takes them for "
      "noise, may be wrong; "
      "check which point belongs to which, and that no sensor or board moved",
      100.0 * *share, 100.0 * kUsual);
}

}  // namespace sextant
