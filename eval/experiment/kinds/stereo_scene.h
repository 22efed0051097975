// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "base/error.h"
#include "geometry/point_cloud.h"
#include "simulator/scene/scene.h"

namespace sextant {

/// Observations of the two stereo cameras of a scene.
struct StereoPair {
  std::array<PointCloud, 2> clouds{};  ///< One cloud per camera, in the camera's frame.
  /// Points of each cloud on each wall, assigned with the true poses; only walls with enough points
  /// in both clouds.
  std::vector<std::array<std::vector<Eigen::Vector3d>, 2>> walls{};
  /// The checkerboard's corners triangulated by each camera; empty if one of them does not see it.
  std::array<std::vector<Eigen::Vector3d>, 2> checker{};
};

/// Renders the scene with its first two cameras, each with a second camera 12 cm to its right like
/// a ZED. Of the boards only those with a checkerboard are rendered: the boards with tags are
/// removed after the calibration. Errors: those of RenderStereo and MatchStereo.
Expected<StereoPair> RenderStereoPair(const Scene& scene);

/// RMS over the walls of the mean signed distance [m] of the first cloud's points, transformed by
/// the pose, from the plane through the second cloud's points; NaN if both see no common wall.
double WallOffset(const StereoPair& pair, const Rigid3d& cam2_from_cam1);

/// Distance [m] between the means of both cameras' corners under the pose; NaN if there are none.
double CheckerOffset(const StereoPair& pair, const Rigid3d& cam2_from_cam1);

}  // namespace sextant
