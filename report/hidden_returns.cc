// SPDX-License-Identifier: Apache-2.0
#include "report/hidden_returns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace sextant {
namespace {

// The returns in a grid of cells of the window's size, so that nine cells contain all neighbours.
class Neighbourhood {
 public:
  Neighbourhood(const std::vector<ProjectedReturn>& returns, const Eigen::Vector2d& window)
      : returns_(returns), window_(window) {
    for (std::size_t i = 0; i < returns.size(); ++i) cells_[CellOf(returns[i].pixel)].push_back(i);
  }

  bool IsSurrounded(const ProjectedReturn& seen) const {
    std::array<bool, 4> quadrants{};
    const Cell center = CellOf(seen.pixel);
    for (long dx = -1; dx <= 1; ++dx) {
      for (long dy = -1; dy <= 1; ++dy) {
        const auto cell = cells_.find({center.first + dx, center.second + dy});
        if (cell != cells_.end()) MarkQuadrants(seen, cell->second, quadrants);
      }
    }
    return std::count(quadrants.begin(), quadrants.end(), true) >= 3;
  }

 private:
  using Cell = std::pair<long, long>;

  Cell CellOf(const Eigen::Vector2d& pixel) const {
    return {std::lround(std::floor(pixel.x() / window_.x())),
            std::lround(std::floor(pixel.y() / window_.y()))};
  }

  void MarkQuadrants(const ProjectedReturn& seen, const std::vector<std::size_t>& others,
                     std::array<bool, 4>& quadrants) const {
    for (const std::size_t i : others) {
      const Eigen::Vector2d to = returns_[i].pixel - seen.pixel;
      if ((to.cwiseAbs().array() > window_.array()).any()) continue;
      if (returns_[i].distance_m > 0.9 * seen.distance_m - 0.2) continue;
      quadrants[(to.x() > 0.0 ? 1U : 0U) + (to.y() > 0.0 ? 2U : 0U)] = true;
    }
  }

  const std::vector<ProjectedReturn>& returns_;
  Eigen::Vector2d window_;
  std::map<Cell, std::vector<std::size_t>> cells_;
};

}  // namespace

std::vector<bool> HiddenReturns(const std::vector<ProjectedReturn>& returns,
                                const SampleSpacing& spacing) {
  constexpr double kSamples = 2.0;
  const Eigen::Vector2d samples(std::max(1.0, spacing.across_px), std::max(1.0, spacing.down_px));
  const Neighbourhood neighbourhood(returns, kSamples * samples);
  std::vector<bool> hidden(returns.size());
  for (std::size_t i = 0; i < returns.size(); ++i) {
    hidden[i] = neighbourhood.IsSurrounded(returns[i]);
  }
  return hidden;
}

}  // namespace sextant
