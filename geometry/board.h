// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace sextant {

/// A square marker printed on a board.
struct BoardTag {
  std::string family{};  ///< "aruco_original", "aruco_6x6_250", "tag36h11", ...
  int id = 0;
  double edge_m = 0.0;  ///< Side of the square whose corners detectors report.
  Eigen::Vector2d center_in_board_m = Eigen::Vector2d::Zero();
  double rotation_rad = 0.0;  ///< Clockwise as seen; 0: the tag's top points to the board's.
};

/// A checkerboard printed on a board, centred at `center_in_board_m`.
struct BoardChecker {
  int inner_columns = 0;  ///< Inner corners along x.
  int inner_rows = 0;     ///< Inner corners along y.
  double square_m = 0.0;
  Eigen::Vector2d center_in_board_m = Eigen::Vector2d::Zero();
  bool starts_white = false;  ///< Whether the square at the top left is white instead of black.
  /// Whether tags of the board are in the white squares (ChArUco). The corners are then found from
  /// the tags, and need not all be in the image.
  bool holds_tags = false;
};

/// The opening of a hollow board, its sides parallel to the board's.
struct BoardHole {
  double width_m = 0.0;   ///< Along x.
  double height_m = 0.0;  ///< Along y.
  Eigen::Vector2d center_in_board_m = Eigen::Vector2d::Zero();
};

/// A round opening through a board (FAST-Calib, velo2cam).
struct RoundHole {
  double radius_m = 0.0;
  Eigen::Vector2d center_in_board_m = Eigen::Vector2d::Zero();
};

/// The number of the rim of Board::round_holes[0] among the sides of a board; 0 to 3 are its outer
/// sides, 4 to 7 those of its rectangular opening.
inline constexpr int kFirstRim = 8;
inline constexpr int kMaxRoundHoles = 32;

/// A rectangular board, in any orientation.
///
/// Board frame: origin at the centre of the front, x right and y down along its edges as seen from
/// the front, z into the board, so that the axes of a board that directly faces the camera are
/// those of the camera. Corners are numbered clockwise as seen, from (-x, -y): 0 top, 1 right, 2
/// bottom, 3 left where corner 0 is up. The names of the edges are of that orientation, too.
struct Board {
  int id = 0;
  double top_right_m = 0.0;     ///< Along x: edge from the top to the right corner, and opposite.
  double right_bottom_m = 0.0;  ///< Along y: edge from the right to the bottom corner.
  std::string name{};
  double thickness_m = 0.0;
  std::optional<BoardHole> hole{};  ///< Its corners are 4 to 7, in the same order.
  std::vector<RoundHole> round_holes{};
  std::vector<BoardTag> tags{};
  std::optional<BoardChecker> checker{};

  /// Whether the board has a side, or a rim, of that number.
  bool HasSide(int side) const {
    if (side >= kFirstRim) return side - kFirstRim < static_cast<int>(round_holes.size());
    return side >= 0 && (side < 4 || hole.has_value());
  }

  /// Length of the edge from corner i to corner i + 1 (mod 4).
  std::array<double, 4> EdgeLengths() const {
    return {top_right_m, right_bottom_m, top_right_m, right_bottom_m};
  }
};

inline constexpr int kCornersPerBoard = 4;

}  // namespace sextant
