// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/unexplained_pairs.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace sextant {
namespace {

template <int kSize>
std::optional<double> ShareOf(const std::vector<Eigen::Matrix<double, kSize, 1>>& points,
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
  return std::sqrt(unexplained / spread);
}

}  // namespace

std::optional<double> UnexplainedShare(const CalibrationProblem& problem,
                                       const SolveReport& report) {
  if (problem.pairs_3d3d.empty() == problem.pairs_2d3d.empty()) return std::nullopt;
  if (problem.pairs_2d3d.empty()) {
    std::vector<Eigen::Vector3d> points;
    for (const Pair3d3d& pair : problem.pairs_3d3d) points.push_back(pair.point_in_cam);
    return ShareOf<3>(points, report.evaluation.per_pair_m, report.inliers);
  }
  std::vector<Eigen::Vector2d> pixels;
  for (const Pair2d3d& pair : problem.pairs_2d3d) pixels.push_back(pair.pixel);
  return ShareOf<2>(pixels, report.evaluation.per_pair_px, report.inliers);
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
      "misfit: the residuals are {:.0f} percent of the spread of the measurements, where {:.0f} or "
      "less is usual, so that the stated uncertainty, which takes them for noise, may be wrong; "
      "check which point belongs to which, and that no sensor or board moved",
      100.0 * *share, 100.0 * kUsual);
}

}  // namespace sextant
