// SPDX-License-Identifier: Apache-2.0
#include "report/hidden_returns.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "features/lidar/rings/scan_rings.h"
#include "report/quadrant_front.h"
#include "report/thinned_scan.h"

namespace sextant {
namespace {

struct WindowCell {
  int column = 0;
  int row = 0;
};

// Returns in cells of the window's size, so that nine cells contain all neighbours, and the cells
// in square tiles, which are examined one by one.
class ReturnTiles {
 public:
  ReturnTiles(const std::vector<ProjectedReturn>& returns, const Eigen::Vector2d& window)
      : returns_(returns), window_(window) {
    Eigen::Vector2d high = returns.front().pixel;
    low_ = high;
    for (const ProjectedReturn& r : returns) {
      low_ = low_.cwiseMin(r.pixel);
      high = high.cwiseMax(r.pixel);
    }
    low_ = window_.array() * (low_.array() / window_.array()).floor();
    const WindowCell last = CellOf(high);
    columns_ = last.column / kCells + 1;
    rows_ = last.row / kCells + 1;
    Sort();
  }

  int tiles() const { return columns_ * rows_; }

  // Whether each return of a tile is surrounded by nearer ones.
  void Examine(int tile, std::vector<std::uint8_t>& hidden) const {
    const int column = tile % columns_;
    const int row = tile / columns_;
    if (starts_[Index(tile)] == starts_[Index(tile + 1)]) return;
    TileFronts fronts({column * kCells - 1, row * kCells - 1});
    const std::vector<std::uint32_t> near = AroundTile(column, row);
    std::size_t next = 0;
    for (const std::uint32_t i : near) {
      const ProjectedReturn& seen = returns_[i];
      const WindowCell cell = CellOf(seen.pixel);
      if (cell.column / kCells != column || cell.row / kCells != row) continue;
      while (next < near.size() && IsBefore(returns_[near[next]], seen)) {
        const Eigen::Vector2d& pixel = returns_[near[next]].pixel;
        fronts.At(CellOf(pixel)).Add(pixel);
        ++next;
      }
      hidden[i] = IsSurrounded(seen.pixel, cell, fronts) ? 1 : 0;
    }
  }

 private:
  static constexpr int kCells = 16;  // Along the side of a tile.

  static std::size_t Index(int i) { return static_cast<std::size_t>(i); }

  static bool IsBefore(const ProjectedReturn& other, const ProjectedReturn& seen) {
    return other.distance_m <= 0.9 * seen.distance_m - 0.2;
  }

  // The nearer returns in each cell of a tile and of the cells around it.
  class TileFronts {
   public:
    explicit TileFronts(const WindowCell& first) : first_(first), cells_(kSide * kSide) {}
    QuadrantFront& At(const WindowCell& cell) {
      return cells_[Index((cell.row - first_.row) * kSide + cell.column - first_.column)];
    }

   private:
    static constexpr int kSide = kCells + 2;
    WindowCell first_;
    std::vector<QuadrantFront> cells_;
  };

  WindowCell CellOf(const Eigen::Vector2d& pixel) const {
    const Eigen::Vector2d cell = ((pixel - low_).array() / window_.array()).floor();
    return {static_cast<int>(cell.x()), static_cast<int>(cell.y())};
  }

  int TileOf(const Eigen::Vector2d& pixel) const {
    const WindowCell cell = CellOf(pixel);
    return cell.row / kCells * columns_ + cell.column / kCells;
  }

  // Counting sort of the indices by tile.
  void Sort() {
    starts_.assign(Index(tiles() + 1), 0);
    for (const ProjectedReturn& r : returns_) ++starts_[Index(TileOf(r.pixel) + 1)];
    for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
    std::vector<std::uint32_t> place(starts_.begin(), starts_.end() - 1);
    sorted_.resize(returns_.size());
    for (std::size_t i = 0; i < returns_.size(); ++i) {
      sorted_[place[Index(TileOf(returns_[i].pixel))]++] = static_cast<std::uint32_t>(i);
    }
  }

  // The returns of a tile and of the cells around it, by ascending distance.
  std::vector<std::uint32_t> AroundTile(int column, int row) const {
    std::vector<std::uint32_t> near;
    for (int y = std::max(0, row - 1); y <= std::min(rows_ - 1, row + 1); ++y) {
      for (int x = std::max(0, column - 1); x <= std::min(columns_ - 1, column + 1); ++x) {
        const int tile = y * columns_ + x;
        for (std::uint32_t k = starts_[Index(tile)]; k < starts_[Index(tile + 1)]; ++k) {
          const WindowCell cell = CellOf(returns_[sorted_[k]].pixel);
          const int dx = cell.column - column * kCells;
          const int dy = cell.row - row * kCells;
          if (dx >= -1 && dx <= kCells && dy >= -1 && dy <= kCells) near.push_back(sorted_[k]);
        }
      }
    }
    std::ranges::sort(near, {}, [this](std::uint32_t i) { return returns_[i].distance_m; });
    return near;
  }

  bool IsSurrounded(const Eigen::Vector2d& pixel, const WindowCell& cell,
                    TileFronts& fronts) const {
    int quadrants = 0;
    for (const int right : {0, 1}) {
      for (const int below : {0, 1}) {
        quadrants += IsCovered(pixel, cell, right == 1, below == 1, fronts) ? 1 : 0;
      }
    }
    return quadrants >= 3;
  }

  // Whether a nearer return is within the window in one quadrant: in the pixel's own cell beyond
  // the pixel, or in the next cell up to the window's end. To the right and below, the pixel itself
  // is excluded; to the left and above it is included.
  bool IsCovered(const Eigen::Vector2d& pixel, const WindowCell& cell, bool right, bool below,
                 TileFronts& fronts) const {
    const int dx = right ? 1 : -1;
    const int dy = below ? 1 : -1;
    const CoordinateBound own_x{.above = right, .limit = pixel.x(), .strict = right};
    const CoordinateBound own_y{.above = below, .limit = pixel.y(), .strict = below};
    const CoordinateBound next_x{
        .above = !right, .limit = pixel.x() + dx * window_.x(), .strict = false};
    const CoordinateBound next_y{
        .above = !below, .limit = pixel.y() + dy * window_.y(), .strict = false};
    return fronts.At(cell).HasWithin(own_x, own_y) ||
           fronts.At({cell.column + dx, cell.row}).HasWithin(next_x, own_y) ||
           fronts.At({cell.column, cell.row + dy}).HasWithin(own_x, next_y) ||
           fronts.At({cell.column + dx, cell.row + dy}).HasWithin(next_x, next_y);
  }

  const std::vector<ProjectedReturn>& returns_;
  Eigen::Vector2d window_;
  Eigen::Vector2d low_;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::uint32_t> starts_;  // Start of each tile in sorted_.
  std::vector<std::uint32_t> sorted_;
};

}  // namespace

SampleSpacing SpacingOf(const PointCloud& scan, const Camera& camera) {
  const std::size_t step = ThinningOf(scan);
  const Expected<ScanRings> rings = ScanRings::Build(step > 1 ? Thinned(scan, step) : scan);
  if (!rings) return {};
  return {.across_px = camera.fx_px * rings->azimuth_step_rad() / static_cast<double>(step),
          .down_px = camera.fy_px * rings->elevation_step_rad()};
}

std::vector<bool> HiddenReturns(const std::vector<ProjectedReturn>& returns,
                                const SampleSpacing& spacing) {
  constexpr double kSamples = 2.0;
  if (returns.empty()) return {};
  const Eigen::Vector2d samples(std::max(1.0, spacing.across_px), std::max(1.0, spacing.down_px));
  const ReturnTiles tiles(returns, kSamples * samples);
  std::vector<std::uint8_t> hidden(returns.size(), 0);
  tbb::parallel_for(0, tiles.tiles(), [&](int tile) { tiles.Examine(tile, hidden); });
  return {hidden.begin(), hidden.end()};
}

}  // namespace sextant
