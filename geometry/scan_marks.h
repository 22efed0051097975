// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "geometry/camera.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// Four corners in the order in which they were drawn, either way round [px].
using Quadrilateral = std::array<Eigen::Vector2d, 4>;

/// A board's edges as a person marks them (Dhall et al. 2017): a quadrilateral round each, drawn on
/// the projected scan. The top-left edge first, then clockwise: top-right, bottom-right,
/// bottom-left. Four where the board is complete.
struct MarkedBoard {
  int id = 0;
  std::vector<Quadrilateral> edges{};
};

/// A board's corner, clicked in the photo.
struct ClickedCorner {
  int board = 0;
  int corner = 0;  ///< As Board numbers them: 0 top, 1 right, 2 bottom, 3 left.
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
};

/// What a person marked in one scan and its photo.
struct ScanMarks {
  /// How the scan was projected when it was marked: what the quadrilaterals refer to. Rough is
  /// enough: nothing is measured with it.
  Camera camera{};
  Rigid3d cam_from_lidar{};
  std::vector<MarkedBoard> boards{};          ///< From left to right.
  std::vector<ClickedCorner> corners{};       ///< In pixels of the photo, whatever `camera` is.
  std::vector<Eigen::Vector2d> unfinished{};  ///< Clicks of a quadrilateral that has not all four.
};

/// The side, as Board numbers its edges (0 from top to right, clockwise), of edge i of a
/// MarkedBoard.
inline int SideOfMarkedEdge(int edge) { return (edge + 3) % 4; }

/// Whether a pixel lies in the quadrilateral; on its border, either. Any simple quadrilateral,
/// convex or not; of one that crosses itself, either of its two parts.
bool Contains(const Quadrilateral& quadrilateral, const Eigen::Vector2d& pixel);

/// Whether two opposite sides cross: corners drawn in the wrong order.
bool CrossesItself(const Quadrilateral& quadrilateral);

Eigen::Vector2d CenterOf(const Quadrilateral& quadrilateral);

/// Camera axes over the LiDAR's: z where its x is, seen from the same place.
Rigid3d AxesCamFromLidar();

/// A pinhole of that size that looks 90 degrees wide: for a scan of which no camera is known.
Camera AssumedCamera(int width_px, int height_px);

}  // namespace sextant
