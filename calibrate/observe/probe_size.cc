// SPDX-License-Identifier: Apache-2.0
#include "calibrate/observe/probe_size.h"

#include <fmt/core.h>

#include <cmath>
#include <optional>

#include "calibrate/observe/board_scale.h"
#include "features/lidar/corner_extractor.h"

namespace sextant {
namespace {

constexpr double kSameRange = 0.3;  // Relative; the sensors are not in one place.
constexpr double kStep = 1.07;      // The search tolerates a size that is a few percent off.
constexpr int kStepsEachWay = 6;    // From two thirds of the size to one and a half.

// Measured by lines fitted without a known size; where that fails, the size of the search.
std::string SizeOf(const BoardPatch& patch, const Board& board) {
  double width = board.top_right_m;
  double height = board.right_bottom_m;
  if (const auto corners = ExtractCorners("plane_lines", patch, board)) {
    const std::vector<double>& edges = corners->checks.edge_lengths_m;
    width = 0.5 * (edges[0] + edges[2]);
    height = 0.5 * (edges[1] + edges[3]);
  }
  return fmt::format("{:.2f} x {:.2f} m", width, height);
}

}  // namespace

std::vector<std::string> ProbeSizes(const PointCloud& cloud, std::span<const Board> boards,
                                    std::span<const PhotoRange> in_image,
                                    const BoardSearchOptions& options) {
  std::vector<std::string> lines;
  const Expected<ScanRings> rings = ScanRings::Build(cloud);
  if (!rings) return lines;
  for (const PhotoRange& seen : in_image) {
    const Board& board = boards[static_cast<std::size_t>(seen.board)];
    std::optional<BoardPatch> best;
    Board best_board;
    for (int i = -kStepsEachWay; i <= kStepsEachWay; ++i) {
      std::vector<Board> scaled = {board};
      ScaleOutline(std::pow(kStep, i), scaled.front());
      const Expected<BoardSearch> search = FindBoards(*rings, scaled, options);
      if (!search || search->found.empty()) continue;
      const BoardPatch& patch = search->found.front();
      const double range_m = patch.plane.At(patch.fit.center).norm();
      if (std::abs(range_m - seen.range_m) > kSameRange * seen.range_m) continue;
      if (best && best->fit.rms <= patch.fit.rms) continue;
      best = patch;
      best_board = scaled.front();
    }
    if (!best) continue;
    const Eigen::Vector3d center = best->plane.At(best->fit.center);
    lines.push_back(fmt::format(
        "board file: the scan shows no board {} of {:.3f} x {:.3f} m, but one of about {} at "
        "({:.2f}, {:.2f}, {:.2f}) m, {:.1f} m away, and the photo shows it {:.1f} m away: measure "
        "the board",
        board.id, board.top_right_m, board.right_bottom_m, SizeOf(*best, best_board), center.x(),
        center.y(), center.z(), center.norm(), seen.range_m));
  }
  return lines;
}

}  // namespace sextant
