// SPDX-License-Identifier: Apache-2.0
#include "calibrate/observe/board_placement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "geometry/board_check.h"

namespace sextant {
namespace {

constexpr double kRefused = 100.0;
constexpr double kOtherSize =
    0.12;  // Relative to a side; some sensors stretch boards by 7 percent.
constexpr double kMaxMisfit = 25.0;
constexpr double kOutlier =
    16.0;  // Chi-square of an edge point on no side: FitRectangle's 4 sigma.

double ChiSquare(const RectangleFit& fit) {
  double sum = 0.0;
  for (const int side : fit.sides) sum += side < 0 ? kOutlier : fit.rms * fit.rms;
  return sum;
}

// Converts a corner or side number (in groups of four) of the board turned by `turns` quarter turns
// into the number on the board itself. Rims of round holes keep their numbers (Turned).
int BoardNumber(int number, int turns) {
  if (number < 0 || number >= kFirstRim) return number;
  return number / 4 * 4 + (number + 4 - turns) % 4;
}

LidarCorners InBoardOrder(const LidarCorners& turned, int turns) {
  LidarCorners own = turned;
  const auto count = static_cast<int>(turned.in_lidar.size());
  for (int i = 0; i < count; ++i) {
    const int to = BoardNumber(i, turns);
    const auto k = static_cast<std::size_t>(i);
    const auto k_to = static_cast<std::size_t>(to);
    own.in_lidar[k_to] = turned.in_lidar[k];
    own.checks.points_per_edge[k_to] = turned.checks.points_per_edge[k];
    own.checks.edge_lengths_m[k_to] = turned.checks.edge_lengths_m[k];
    own.checks.line_gaps_m[k_to] = turned.checks.line_gaps_m[k];
    for (int j = 0; j < count; ++j) {
      own.covariance.block<3, 3>(3 * to, 3 * BoardNumber(j, turns)) =
          turned.covariance.block<3, 3>(3 * i, 3 * j);
    }
  }
  return own;
}

// The fit of the turned board is the fit of the board itself with its x axis rotated by a quarter
// turn per turn.
BoardPlacement Place(const LidarPlane& plane, const RectangleFit& turned, int board, int turns) {
  BoardPlacement placement{.board = board, .turn = turns, .fit = turned};
  placement.fit.angle_rad += turns * 0.5 * std::numbers::pi;
  for (int& side : placement.fit.sides) side = BoardNumber(side, turns);
  Eigen::Matrix3d lidar_from_plane;
  lidar_from_plane << plane.x_axis, plane.y_axis, plane.normal;
  const Eigen::AngleAxisd in_plane(placement.fit.angle_rad, Eigen::Vector3d::UnitZ());
  placement.lidar_from_board = {
      Eigen::Quaterniond(lidar_from_plane * in_plane.toRotationMatrix()).normalized(),
      plane.At(placement.fit.center)};
  return placement;
}

// The fit of a board to the patch, which may have been found as another board.
std::optional<RectangleFit> UprightFit(const BoardPatch& patch, int index, const Board& board) {
  if (index == patch.board) return patch.fit;
  const Eigen::Vector3d placed(patch.fit.center.x(), patch.fit.center.y(), patch.fit.angle_rad);
  return FitRectangle(patch.edges, board, {&placed, 1});
}

// Quarter turns that need a fit of their own. The same after half a turn, unless the openings are
// not; after a quarter turn, the sides are exchanged.
int TurnsToFit(const Board& board) { return HolesAllowTurns(board, 2) ? 2 : 4; }

// Rim numbers after half a turn.
void RenumberRims(const Board& board, std::vector<int>& sides) {
  for (int& side : sides) {
    if (side >= kFirstRim) side = SideAfterTurn(board, side, 2);
  }
}

// The outline as it appears in the scan.
Board OutlineOf(const BoardPlacement& placement, std::span<const Board> boards) {
  return Turned(boards[static_cast<std::size_t>(placement.board)], placement.turn);
}

bool AreSimilar(const Board& a, const Board& b) {
  const auto similar = [](double x, double y) {
    return std::abs(x - y) < kOtherSize * std::max(x, y);
  };
  return similar(a.top_right_m, b.top_right_m) && similar(a.right_bottom_m, b.right_bottom_m);
}

}  // namespace

Board Turned(const Board& board, int quarter_turns) {
  Board turned = board;
  turned.tags.clear();
  turned.checker.reset();
  for (int i = 0; i < quarter_turns; ++i) {
    std::swap(turned.top_right_m, turned.right_bottom_m);
    for (RoundHole& hole : turned.round_holes) {
      hole.center_in_board_m =
          Eigen::Vector2d(-hole.center_in_board_m.y(), hole.center_in_board_m.x());
    }
    if (!turned.hole) continue;
    std::swap(turned.hole->width_m, turned.hole->height_m);
    const Eigen::Vector2d center = turned.hole->center_in_board_m;
    turned.hole->center_in_board_m = {-center.y(), center.x()};
  }
  return turned;
}

Expected<std::vector<BoardPlacement>> PlaceBoards(const BoardPatch& patch,
                                                  std::span<const Board> boards,
                                                  const std::string& extractor, std::string& why) {
  std::vector<BoardPlacement> placements;
  for (std::size_t b = 0; b < boards.size(); ++b) {
    const std::optional<RectangleFit> upright = UprightFit(patch, static_cast<int>(b), boards[b]);
    for (int turns = 0; upright && turns < TurnsToFit(boards[b]); ++turns) {
      const Board turned = Turned(boards[b], turns);
      const std::optional<RectangleFit> fit =
          turns == 0 ? upright
                     : RefineRectangle(patch.edges, turned, upright->center, upright->angle_rad);
      if (!fit) continue;
      BoardPatch fitted = patch;
      fitted.board = static_cast<int>(b);
      fitted.fit = *fit;
      const Expected<LidarCorners> corners = ExtractCorners(extractor, fitted, turned);
      if (!corners && corners.error().code == ErrorCode::kUnknownName) {
        return tl::unexpected<Error>(corners.error());
      }
      if (!corners) {
        why = corners.error().message;
        continue;
      }
      for (int turn = turns; turn < 4; turn += TurnsToFit(boards[b])) {
        placements.push_back(Place(patch.plane, *fit, fitted.board, turn));
        if (turn != turns) RenumberRims(boards[b], placements.back().fit.sides);
        placements.back().corners = InBoardOrder(*corners, turn);
        placements.back().misfit = ChiSquare(*fit);
      }
    }
  }
  if (placements.empty()) return placements;
  std::ranges::stable_sort(placements, {}, &BoardPlacement::misfit);
  const double best = placements.front().misfit;
  const double unit = std::max(1.0, best / static_cast<double>(patch.edges.size()));
  const Board likeliest = OutlineOf(placements.front(), boards);
  for (BoardPlacement& placement : placements) placement.misfit = (placement.misfit - best) / unit;
  std::erase_if(placements, [&](const BoardPlacement& placement) {
    return placement.misfit > kRefused && !AreSimilar(OutlineOf(placement, boards), likeliest);
  });
  for (BoardPlacement& placement : placements) {
    placement.misfit = std::min(placement.misfit, kMaxMisfit);
  }
  return placements;
}

}  // namespace sextant
