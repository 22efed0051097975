// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "features/lidar/board_finder.h"
#include "geometry/board.h"

namespace sextant {

struct FaceOfBoard {
  std::vector<Eigen::Vector3d> in_lidar{};  ///< [m].
  std::vector<int> rings{};                 ///< One for each; empty where the sensor has no rings.
};

/// The patch's returns inside the fitted outline.
FaceOfBoard FaceReturns(const ScanRings& scan, const BoardPatch& patch,
                        std::span<const Board> boards);

/// Standard deviation of the returns' ranges about the ranges at which their rays meet the plane
/// [m]. The plane's own sigma for fewer than four returns.
double RangeSigma(std::span<const Eigen::Vector3d> face, const LidarPlane& plane);

}  // namespace sextant
