// SPDX-License-Identifier: Apache-2.0
#include "solvers/core/plausible.h"

#include <fmt/core.h>

#include <cmath>
#include <span>

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

}  // namespace

Expected<void> CheckPlausible(const CalibrationProblem& problem, const SolverSpec& spec,
                              const SolveReport& report) {
  constexpr std::size_t kMinPairs = 4;
  const std::vector<int>& used = report.inliers;
  const bool of_pixels = spec.needs.pairs_2d3d > 0 && spec.needs.pairs_3d3d == 0;
  if (!of_pixels || used.size() < kMinPairs) return {};
  double squares = 0.0;
  std::size_t projected = 0;
  for (const int i : used) {
    const double residual = report.evaluation.per_pair_px[static_cast<std::size_t>(i)];
    if (!std::isfinite(residual)) continue;
    squares += residual * residual;
    ++projected;
  }
  if (2 * projected < used.size()) {
    return MakeError(ErrorCode::kNoConsensus,
                     fmt::format("{}: its pose has {} of {} points behind the camera or outside "
                                 "the lens model; check the signs of the axes, the camera and "
                                 "which pixel belongs to which point",
                                 spec.name, used.size() - projected, used.size()));
  }
  const double mean = squares / static_cast<double>(projected);
  const double spread = SquaredSpread(problem.pairs_2d3d, used);
  if (mean <= spread) return {};
  return MakeError(
      ErrorCode::kNoConsensus,
      fmt::format("{}: its pose leaves {:.3g} px, and the pixels themselves spread over {:.3g} px, "
                  "so it explains nothing; check which pixel belongs to which point, and the "
                  "camera",
                  spec.name, std::sqrt(mean), std::sqrt(spread)));
}

}  // namespace sextant
