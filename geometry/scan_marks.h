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

/// A board's edges as marked by a person (Dhall et al. 2017): a quadrilateral around each, drawn on
/// the projected scan. The top-left edge first, then clockwise: top-right, bottom-right,
/// bottom-left. Four where the board is complete.
struct MarkedBoard {
  int id = 0;
  std::vector<Quadrilateral> edges{};
};

/// A board's corner, clicked in the photo.
struct ClickedCorner {
  int board = 0;
  int corner = 0;  ///< Numbered as in Board: 0 top, 1 right, 2 bottom, 3 left.
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
};

/// The marks of a person in one scan and its photo.
struct ScanMarks {
  /// The projection of the scan during marking, to which the quadrilaterals refer. An approximate
  /// one suffices, as nothing is measured with it.
  Camera camera{};
  Rigid3d cam_from_lidar{};
  std::vector<MarkedBoard> boards{};          ///< From left to right.
  std::vector<ClickedCorner> corners{};       ///< In pixels of the photo, independent of `camera`.
  std::vector<Eigen::Vector2d> unfinished{};  ///< Clicks of an incomplete quadrilateral.
};

/// The side, numbered as the edges of Board (0 from top to right, clockwise), of edge i of a
/// MarkedBoard.
inline int SideOfMarkedEdge(int edge) { return (edge + 3) % 4; }

/// Whether a pixel lies in the quadrilateral; on its border, the result is unspecified. Any simple
/// quadrilateral, convex or not; for one that crosses itself, either of its two parts.
bool Contains(const Quadrilateral& quadrilateral, const Eigen::Vector2d& pixel);

/// Whether two opposite sides cross: corners drawn in the wrong order.
bool CrossesItself(const Quadrilateral& quadrilateral);

Eigen::Vector2d CenterOf(const Quadrilateral& quadrilateral);

/// The rotation from LiDAR axes to camera axes (camera z along LiDAR x), without translation.
Rigid3d AxesCamFromLidar();

/// A pinhole of that image size with a 90 degree horizontal field of view: for a scan without a
/// known camera.
Camera AssumedCamera(int width_px, int height_px);

}  // namespace sextant
