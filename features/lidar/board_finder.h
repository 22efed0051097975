// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "features/lidar/edge_points.h"
#include "features/lidar/lidar_plane.h"
#include "features/lidar/rectangle_fit.h"
#include "features/lidar/scan_rings.h"
#include "geometry/board.h"

namespace sextant {

/// A box in the LiDAR frame to which the search is restricted [m].
struct LidarRegion {
  Eigen::Vector3d low = Eigen::Vector3d::Zero();
  Eigen::Vector3d high = Eigen::Vector3d::Zero();
};

struct BoardSearchOptions {
  std::optional<LidarRegion> region{};
  bool correct_edges = true;  ///< For the samples' distance and the beam's width; see EdgePoint.
  LidarBeam beam{};
  std::uint64_t seed = 1;
};

/// How well a patch of a scan agrees with a board placed on it.
struct BoardAgreement {
  int rings = 0;
  int points = 0;          ///< On the board.
  double density = 0.0;    ///< Returns on it, of those that the sensor's steps make one expect.
  double filled = 0.0;     ///< Share of the rays onto the board that end on it.
  double visible = 0.0;    ///< Share of them that nothing nearer stops.
  double contained = 0.0;  ///< Share of the patch's points that lie within the board.
  double continued = 0.0;  ///< Share of those around it that end in its plane too.
};

/// One board in a scan.
struct BoardPatch {
  int board = 0;  ///< Place within the boards that were looked for.
  LidarPlane plane{};
  std::vector<std::size_t> on_plane{};  ///< Places within ScanRings::points(), ascending.
  std::vector<EdgePoint> edges{};
  RectangleFit fit{};
  BoardAgreement agreement{};
};

/// Something flat of about a board's size that is none, and why.
struct RejectedPatch {
  Eigen::Vector3d center_in_lidar = Eigen::Vector3d::Zero();
  int rings = 0;
  int points = 0;
  std::string why{};
};

struct BoardSearch {
  std::vector<BoardPatch> found{};        ///< At most one a board, in the order of the boards.
  std::vector<RejectedPatch> rejected{};  ///< Those with most points first.
};

inline constexpr int kMinRings = 4;  ///< A board seen by fewer has too few edge points.

/// Boards of known size among everything else: clusters of the scan no wider than a board, the
/// plane that most of each lies on, the rectangle that its edges fit. Boards of nearly the same
/// size go from left to right by their order in `boards`, as the paper hangs them.
/// Errors: kInvalidInput for boards without a size.
Expected<BoardSearch> FindBoards(const ScanRings& scan, std::span<const Board> boards,
                                 const BoardSearchOptions& options);

}  // namespace sextant
