// SPDX-License-Identifier: Apache-2.0
#include "solvers/core/plausible.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace sextant {
namespace {

// Mean squared distance of the pixels at `indices` from their mean.
double SquaredSpread(std::span<const Pair2d3d> pairs, std::span<const int> indices) {
  const Eigen::Vector2d origin = pairs[static_cast<std::size_t>(indices.front())].pixel;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double squares = 0.0;
  for (const int i : indices) {
    const Eigen::Vector2d arm = pairs[static_cast<std::size_t>(i)].pixel - origin;
    sum += arm;
    squares += arm.squaredNorm();
  }
  const auto count = static_cast<double>(indices.size());
  return (squares - sum.squaredNorm() / count) / count;
}

// The squared distances of the pixels from their mean add up to at least this, from two pixels.
double LeastExtent(std::span<const Pair2d3d> pairs, std::span<const int> indices) {
  const Eigen::Vector2d& first = pairs[static_cast<std::size_t>(indices.front())].pixel;
  const Eigen::Vector2d& last = pairs[static_cast<std::size_t>(indices.back())].pixel;
  return 0.5 * (first - last).squaredNorm();
}

// The sum over all pairs, in one vectorised pass; infinite where one does not project.
double SumOfSquares(const std::vector<double>& residuals) {
  return Eigen::Map<const Eigen::VectorXd>(residuals.data(),
                                           static_cast<Eigen::Index>(residuals.size()))
      .squaredNorm();
}

}  // namespace

Expected<void> CheckPlausible(const CalibrationProblem& problem, const SolverSpec& spec,
                              const SolveReport& report) {
  constexpr std::size_t kMinPairs = 4;
  const std::vector<int>& used = report.inliers;
  const bool of_pixels = spec.needs.pairs_2d3d > 0 && spec.needs.pairs_3d3d == 0;
  if (!of_pixels || used.size() < kMinPairs) return {};
  const std::vector<double>& residuals = report.evaluation.per_pair_px;
  const std::span<const Pair2d3d> pairs = problem.pairs_2d3d;
  // A mean square of half of the spread leaves half of the pairs or more within it. That of all
  // pairs bounds that of the used ones.
  if (2.0 * SumOfSquares(residuals) <= LeastExtent(pairs, used)) return {};
  const auto projected =
      static_cast<std::size_t>(std::count_if(used.begin(), used.end(), [&](int i) {
        return std::isfinite(residuals[static_cast<std::size_t>(i)]);
      }));
  if (2 * projected < used.size()) {
    return MakeError(ErrorCode::kNoConsensus,
                     fmt::format("{}: its pose has {} of {} points behind the camera or outside "
                                 "the lens model; check the signs of the axes, the camera and "
                                 "which pixel belongs to which point",
                                 spec.name, used.size() - projected, used.size()));
  }
  const double spread = SquaredSpread(pairs, used);
  const auto explained =
      static_cast<std::size_t>(std::count_if(used.begin(), used.end(), [&](int i) {
        const double residual = residuals[static_cast<std::size_t>(i)];
        return residual * residual <= spread;
      }));
  if (2 * explained >= used.size()) return {};
  return MakeError(ErrorCode::kNoConsensus,
                   fmt::format("{}: its pose leaves more than {:.3g} px, by which the pixels "
                               "themselves spread, at {} of {} pairs, so it explains nothing; "
                               "check which pixel belongs to which point, and the camera",
                               spec.name, std::sqrt(spread), used.size() - explained, used.size()));
}

}  // namespace sextant
