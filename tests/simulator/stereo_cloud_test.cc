// SPDX-License-Identifier: Apache-2.0
#include "simulator/session/stereo_cloud.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "simulator/scene/scene_pose.h"

namespace sextant {
namespace {

constexpr double kFocal_px = 350.0;
constexpr double kBaseline_m = 0.12;

// A speckled, slightly rotated wall 2 m in front of a VGA camera.
Scene WallScene() {
  Scene scene;
  scene.name = "wall";
  SceneCamera camera{.name = "cam"};
  camera.intrinsics = {.model = CameraModel::kBrownConrady,
                       .width_px = 320,
                       .height_px = 240,
                       .fx_px = kFocal_px,
                       .fy_px = kFocal_px,
                       .cx_px = 159.5,
                       .cy_px = 119.5,
                       .distortion = {-0.1, 0.01}};
  camera.world_from_cam = {SceneRotation(SceneAxes::kForwardIsZ, {}), {0.0, 0.0, 1.0}};
  scene.cameras.push_back(camera);
  SceneWall wall{.name = "wall", .width_m = 6.0, .height_m = 6.0, .surface = {0.5, 0.9}};
  wall.world_from_wall = {SceneRotation(SceneAxes::kForwardIsZ, {.yaw = 0.3}), {2.0, 0.0, 1.0}};
  wall.tile_m = 0.02;
  wall.speckled = true;
  scene.walls.push_back(wall);
  return scene;
}

Expected<PointCloud> CloudOf(const Scene& scene) {
  const Expected<StereoImages> images =
      RenderStereo(scene, 0, kBaseline_m, UsualImageOptions(3, 0.0));
  if (!images) return tl::unexpected<Error>(images.error());
  return MatchStereo(*images, {});
}

// For most points the error along z is below a third of a pixel of disparity.
TEST(StereoCloud, PointsLieOnTheWall) {
  const Scene scene = WallScene();
  const Expected<PointCloud> cloud = CloudOf(scene);
  ASSERT_TRUE(cloud) << cloud.error().message;
  // Pixels left of the largest disparity have no match.
  const double most_px = kFocal_px * kBaseline_m / 0.8 + 16.0;
  EXPECT_GT(cloud->points.size(), 0.9 * 240.0 * (320.0 - most_px));
  ASSERT_EQ(cloud->intensity.size(), cloud->points.size());
  const Rigid3d wall_from_cam =
      scene.walls[0].world_from_wall.Inverse() * scene.cameras[0].world_from_cam;
  std::vector<double> errors_px;
  double sum_px = 0.0;
  for (const Eigen::Vector3d& point : cloud->points) {
    const double off_m = (wall_from_cam * point).z();
    const double error_px = off_m * kFocal_px * kBaseline_m / (point.z() * point.z());
    errors_px.push_back(std::abs(error_px));
    sum_px += error_px;
  }
  const auto p90 = errors_px.begin() + static_cast<std::ptrdiff_t>(errors_px.size() * 9 / 10);
  std::ranges::nth_element(errors_px, p90);
  EXPECT_LT(*p90, 0.34);
  EXPECT_LT(std::abs(sum_px / static_cast<double>(errors_px.size())), 0.1);
}

TEST(StereoCloud, TheSameSeedGivesTheSamePoints) {
  const Scene scene = WallScene();
  EXPECT_EQ(CloudOf(scene)->points, CloudOf(scene)->points);
}

TEST(StereoCloud, BlankWallsGiveNoPoints) {
  Scene scene = WallScene();
  scene.walls[0].tile_m = 0.0;
  const Expected<PointCloud> cloud = CloudOf(scene);
  ASSERT_TRUE(cloud);
  EXPECT_LT(cloud->points.size(), 320U * 240U / 10U);
}

TEST(StereoCloud, TriangulationInvertsProjection) {
  StereoImages images;
  images.camera = {.fx_px = 700.0, .fy_px = 690.0, .cx_px = 639.5, .cy_px = 359.5};
  images.baseline_m = kBaseline_m;
  const Eigen::Vector3d point(0.3, -0.2, 2.5);
  const Eigen::Vector2d left = *Project(images.camera, point);
  const Eigen::Vector2d right =
      *Project(images.camera, point - Eigen::Vector3d(kBaseline_m, 0.0, 0.0));
  EXPECT_LT((*Triangulate(images, left, right) - point).norm(), 1e-12);
  EXPECT_FALSE(Triangulate(images, right, left));
}

// The rectified pair is one of pinholes, whatever the lens.
TEST(StereoCloud, ALensOfAnyModelIsRectified) {
  Scene scene = WallScene();
  Camera& lens = scene.cameras[0].intrinsics;
  lens.model = CameraModel::kOmnidirectional;
  lens.xi = 1.2;
  lens.skew_px = 0.5;
  const Expected<StereoImages> images = RenderStereo(scene, 0, kBaseline_m, {});
  ASSERT_TRUE(images) << images.error().message;
  EXPECT_EQ(images->camera.model, CameraModel::kPinhole);
}

TEST(StereoCloud, RejectsInvalidOptions) {
  const Scene scene = WallScene();
  const ImageOptions image;
  EXPECT_EQ(RenderStereo(scene, 1, kBaseline_m, image).error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(RenderStereo(scene, 0, 0.0, image).error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(MatchStereo({}, {.farthest_m = 0.5}).error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(MatchStereo({}, {.block_px = 4}).error().code, ErrorCode::kInvalidInput);
}

}  // namespace
}  // namespace sextant
