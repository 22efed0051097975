// SPDX-License-Identifier: Apache-2.0
#include "eval/synthetic/typical_sensors.h"

#include "base/units.h"
#include "geometry/random_vectors.h"

namespace sextant {
Camera ZedLikeCamera() {
  return {.width_px = 1280,
          .height_px = 720,
          .fx_px = 700.0,
          .fy_px = 700.0,
          .cx_px = 639.5,
          .cy_px = 359.5};
}

// Maps the LiDAR's axes (x forward, y left, z up) to the camera's (x right, y down, z forward),
// with a few degrees of mounting error and the paper's offset of a few decimetres.
Rigid3d DrawExtrinsic(Random& random) {
  Eigen::Matrix3d axes;
  axes << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  Rigid3d cam_from_lidar;
  const Eigen::Vector3d turn = 5.0 * kRadPerDeg * NormalVector(random);
  cam_from_lidar.rotation = (ExpSo3(turn) * Eigen::Quaterniond(axes)).normalized();
  cam_from_lidar.translation = Eigen::Vector3d(-0.15, -0.25, -0.18) + 0.05 * NormalVector(random);
  return cam_from_lidar;
}

}  // namespace sextant
