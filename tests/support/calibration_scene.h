// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "base/random.h"
#include "geometry/point_cloud.h"
#include "simulator/scene/scene.h"

namespace sextant::test {

/// The paper's two boards with their tags at random poses about 2 m in front of a LiDAR at the
/// world's origin and a ZED next to it that looks roughly along the LiDAR's x axis.
Scene TaggedBoards(Random& random);

/// cam_from_lidar of the scene's only camera.
Rigid3d TrueCamFromLidar(const Scene& scene);

/// A scan and the image of the scene's camera, with typical sensor noise.
struct SensorData {
  cv::Mat image{};
  PointCloud cloud{};
};
SensorData Record(const Scene& scene, std::uint64_t seed);

}  // namespace sextant::test
