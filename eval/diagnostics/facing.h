// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "geometry/rigid3d.h"

namespace sextant {

/// Whether most planar groups of LiDAR points (boards) lie between the two sensors, so that the
/// sensors look at opposite sides of them, as the answer of corners that are listed clockwise by
/// one sensor and counter-clockwise by the other. A group is planar if it is at most 0.15 times as
/// thick as it is wide. It counts if both sensors are clearly off its plane: by a tenth of its
/// width, at an angle of at least 10 degrees and three times the error of the normal that its
/// thickness shows, and within 10^4 widths of it. False if no group counts.
bool SensorsFaceEachOther(std::span<const std::vector<Eigen::Vector3d>> groups_in_lidar,
                          const Rigid3d& cam_from_lidar);

}  // namespace sextant
