// SPDX-License-Identifier: Apache-2.0
// Random rooms and streets, for what works without a board.
#include "simulator/scene/everyday_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "simulator/camera/render.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/lidar/scan.h"

namespace sextant {
namespace {

class EverydayScenes : public testing::TestWithParam<EverydayPlace> {};

TEST_P(EverydayScenes, AreSeenByBothSensors) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Scene scene = EverydayScene(GetParam(), seed);
    const auto lidar = FindLidarModel("vlp16");
    ASSERT_TRUE(lidar);
    const auto scan = SimulateScan(scene, *lidar, {.seed = seed});
    ASSERT_TRUE(scan) << seed << ": " << scan.error().message;
    const auto ahead = std::ranges::count_if(scan->cloud.points, [](const Eigen::Vector3d& point) {
      return point.x() > std::abs(point.y());
    });
    EXPECT_GT(ahead, 1000) << seed;
    const auto [low, high] = std::ranges::minmax(scan->cloud.intensity);
    EXPECT_GT(high, 2.0F * low) << "the intensity follows the reflectivity";
    Camera& camera = scene.cameras[0].intrinsics;
    camera = {.width_px = 155,
              .height_px = 47,
              .fx_px = 90.0,
              .fy_px = 90.0,
              .cx_px = 77.0,
              .cy_px = 23.0};
    const auto image = RenderImage(scene, 0, {});
    ASSERT_TRUE(image) << seed << ": " << image.error().message;
    cv::Scalar mean;
    cv::Scalar spread;
    cv::meanStdDev(*image, mean, spread);
    EXPECT_GT(spread[0], 8.0) << seed;
  }
}

TEST_P(EverydayScenes, DependOnTheSeedAloneAndShareTheRig) {
  const Scene one = EverydayScene(GetParam(), 5);
  const Scene again = EverydayScene(GetParam(), 5);
  const Scene other = EverydayScene(GetParam(), 6);
  ASSERT_EQ(one.boxes.size(), again.boxes.size());
  for (std::size_t i = 0; i < one.boxes.size(); ++i) {
    EXPECT_EQ(one.boxes[i].size_m, again.boxes[i].size_m);
    EXPECT_EQ(one.boxes[i].surface.albedo, again.boxes[i].surface.albedo);
  }
  EXPECT_NE(one.boxes[0].size_m, other.boxes[0].size_m);
  EXPECT_EQ(one.cameras[0].world_from_cam.Matrix(), other.cameras[0].world_from_cam.Matrix());
}

INSTANTIATE_TEST_SUITE_P(Places, EverydayScenes,
                         testing::Values(EverydayPlace::kRoom, EverydayPlace::kStreet));

}  // namespace
}  // namespace sextant
