// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "base/error.h"
#include "geometry/point_cloud.h"
#include "simulator/scene/scene.h"

namespace sextant {

/// What the two stereo cameras of a scene see of it.
struct StereoPair {
  std::array<PointCloud, 2> clouds{};  ///< Each in its camera's frame.
  /// Points of each wall in each cloud, by the true poses; only walls that both see well.
  std::vector<std::array<std::vector<Eigen::Vector3d>, 2>> walls{};
  /// The checkerboard's corners, triangulated by each; empty where one of them does not see it.
  std::array<std::vector<Eigen::Vector3d>, 2> checker{};
};

/// The scene's first two cameras, each with a second eye 12 cm to its right as a ZED has, and the
/// scene's one board with a checkerboard. Without boards that have tags: they are taken away when
/// the cameras are calibrated. Errors: those of RenderStereo and MatchStereo.
Expected<StereoPair> RenderStereoPair(const Scene& scene);

/// RMS over the walls of the mean distance [m] of the first cloud's points, moved by the pose, from
/// the plane through the second's; NaN where no wall is seen by both.
double WallOffset(const StereoPair& pair, const Rigid3d& cam2_from_cam1);

/// Distance [m] between the means of the corners under the pose; NaN where there are none.
double CheckerOffset(const StereoPair& pair, const Rigid3d& cam2_from_cam1);

}  // namespace sextant
