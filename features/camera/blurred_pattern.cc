// SPDX-License-Identifier: Apache-2.0
#include "features/camera/blurred_pattern.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace sextant {
namespace {

constexpr double kReach = 4.0;  ///< Standard deviations beyond which a step is over.
constexpr int kMostCells = 24;  ///< Along one axis within reach.

// How much of each cell from `first` the blur sees: with h the distance to a cell's side over the
// blur, differences over its two sides of Phi(h) and of phi(h) He_n(h), n = 0 to 3 (Hermite's
// polynomials, each the derivative of the one before but for its sign).
struct Weights {
  int first = 0;
  int count = 0;
  std::array<double, kMostCells> value;
  std::array<std::array<double, 4>, kMostCells> hermite;
};

struct Step {
  double value = 0.0;
  std::array<double, 4> hermite{};
};

Step StepAt(double h) {
  if (h > kReach) return {.value = 1.0, .hermite = {}};
  if (h < -kReach) return {};
  const double density =
      std::exp(-0.5 * h * h) * 0.5 * std::numbers::inv_sqrtpi * std::numbers::sqrt2;
  return {.value = 0.5 * std::erfc(-h / std::numbers::sqrt2),
          .hermite = {density, h * density, (h * h - 1.0) * density, (h * h - 3.0) * h * density}};
}

Weights WeightsAt(double point, double blur) {
  const int low = static_cast<int>(std::floor(point - kReach * blur));
  const int high = static_cast<int>(std::floor(point + kReach * blur));
  Weights weights;
  weights.first = low;
  weights.count = std::min(high - low + 1, kMostCells);
  Step begin{.value = 1.0, .hermite = {}};
  for (int i = 0; i < weights.count; ++i) {
    const Step end = i + 1 == weights.count ? Step{} : StepAt((point - (low + i + 1)) / blur);
    const auto k = static_cast<std::size_t>(i);
    weights.value[k] = begin.value - end.value;
    for (std::size_t n = 0; n < 4; ++n) {
      weights.hermite[k][n] = begin.hermite[n] - end.hermite[n];
    }
    begin = end;
  }
  return weights;
}

}  // namespace

BlurredCell BlurAt(const TagPattern& pattern, const Eigen::Vector2d& point_cells,
                   const Eigen::Vector2d& blur_cells, double correlation) {
  const Weights us = WeightsAt(point_cells.x(), blur_cells.x());
  const Weights vs = WeightsAt(point_cells.y(), blur_cells.y());
  const std::array<double, 3> series = {correlation, correlation * correlation / 2.0,
                                        correlation * correlation * correlation / 6.0};
  // Black cells are taken from white: most of the surroundings need no term then.
  BlurredCell cell{.white = 1.0, .by_point = Eigen::Vector2d::Zero(), .by_relative_blur = 0.0};
  Eigen::Vector2d by_h = Eigen::Vector2d::Zero();
  for (int i = 0; i < vs.count; ++i) {
    const int row = vs.first + i;
    if (row < 0 || row >= pattern.cells) continue;
    const double v = vs.value[static_cast<std::size_t>(i)];
    const std::array<double, 4>& hv = vs.hermite[static_cast<std::size_t>(i)];
    for (int j = 0; j < us.count; ++j) {
      const int column = us.first + j;
      if (column < 0 || column >= pattern.cells || pattern.IsWhite(row, column)) continue;
      const double u = us.value[static_cast<std::size_t>(j)];
      const std::array<double, 4>& hu = us.hermite[static_cast<std::size_t>(j)];
      cell.white -= u * v;
      by_h -= Eigen::Vector2d(hu[0] * v, u * hv[0]);
      cell.by_relative_blur += hu[1] * v + u * hv[1];
      for (std::size_t n = 0; n < series.size(); ++n) {
        cell.white -= series[n] * hu[n] * hv[n];
        by_h += series[n] * Eigen::Vector2d(hu[n + 1] * hv[n], hu[n] * hv[n + 1]);
      }
    }
  }
  cell.by_point = by_h.cwiseQuotient(blur_cells);
  return cell;
}

}  // namespace sextant
