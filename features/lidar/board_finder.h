// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "features/lidar/edge_points.h"
#include "features/lidar/lidar_plane.h"
#include "features/lidar/rectangle_fit.h"
#include "features/lidar/rings/scan_rings.h"
#include "geometry/board.h"

namespace sextant {

/// A box in the LiDAR frame to which the search is restricted [m].
struct LidarRegion {
  Eigen::Vector3d low = Eigen::Vector3d::Zero();
  Eigen::Vector3d high = Eigen::Vector3d::Zero();
};

struct BoardSearchOptions {
  std::optional<LidarRegion> region{};
  bool correct_edges = true;  ///< Correct for the sampling step and the beam width; see EdgePoint.
  LidarBeam beam{};
  std::uint64_t seed = 1;
};

/// Agreement of a scan with a board placed in it.
struct BoardAgreement {
  int rings = 0;
  int points = 0;        ///< Returns on the board.
  int in_holes = 0;      ///< Returns of its plane where it has round holes.
  double density = 0.0;  ///< Returns on it relative to those expected from the sensor's steps.
  double filled = 0.0;   ///< Fraction of the rays onto the board that end on it, not behind it.
  double visible = 0.0;  ///< Fraction of them not blocked by a nearer object.
  double continued =
      0.0;  ///< Fraction of the outline, where rays show it, beyond which its plane goes on.
  /// For each side, the fractions of its length beyond which rays pass the board's plane, and
  /// beyond which they end in it; no rays show the rest.
  std::array<double, kCornersPerBoard> open{};
  std::array<double, kCornersPerBoard> closed{};
};

/// One board in a scan.
struct BoardPatch {
  int board = 0;  ///< Index into the boards of the search.
  LidarPlane plane{};
  std::vector<std::size_t> on_plane{};  ///< Indices into ScanRings::points(), ascending.
  std::vector<EdgePoint> edges{};
  RectangleFit fit{};
  BoardAgreement agreement{};
};

/// A flat patch of about a board's size that was rejected, and why.
struct RejectedPatch {
  Eigen::Vector3d center_in_lidar = Eigen::Vector3d::Zero();
  int rings = 0;
  int points = 0;
  std::string why{};
};

struct BoardSearch {
  std::vector<BoardPatch> found{};  ///< At most one per board, in the order of the boards.
  /// Further patches that may be boards, the likeliest first: more than there are boards of their
  /// size.
  std::vector<BoardPatch> others{};
  std::vector<RejectedPatch> rejected{};  ///< Those with the most points first.
};

inline constexpr int kMinRings = 4;  ///< A board crossed by fewer rings has too few edge points.

/// Finds boards of known size in a scan: clusters no wider than a board, the dominant planes of
/// each, and the placement of the board in such a plane that explains the scan: returns inside its
/// outline, rings that end at its sides, rays that pass its plane beyond them. Other objects may be
/// in its plane, and parts of it may be hidden or outside the field of view. Boards of nearly the
/// same size are assigned from left to right in the order of `boards`, as in the paper. Errors:
/// kInvalidInput for boards without a size.
Expected<BoardSearch> FindBoards(const ScanRings& scan, std::span<const Board> boards,
                                 const BoardSearchOptions& options);

}  // namespace sextant
