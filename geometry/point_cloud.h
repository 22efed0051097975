// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace sextant {

/// One scan of a LiDAR, in the LiDAR frame (x forward, y left, z up) [m].
///
/// Points without a return are NaN or absent. Each field besides `points` is either empty, where
/// the sensor or the file does not provide it, or as long as `points`.
struct PointCloud {
  std::vector<Eigen::Vector3d> points;
  std::vector<float> intensity;     ///< In the sensor's own units.
  std::vector<std::uint16_t> ring;  ///< 0 the lowest elevation.
  std::vector<double> time_s;       ///< Since the start of the scan.
};

}  // namespace sextant
