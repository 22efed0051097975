// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <opencv2/core.hpp>
#include <string>

#include "geometry/so3.h"
#include "simulator/camera/ray_tile.h"
#include "simulator/camera/render.h"
#include "simulator/camera/tag_picture.h"
#include "simulator/scene/camera_model.h"

namespace sextant::test {
namespace {

// World: z up; the camera looks along x.
Rigid3d WorldFromCamera() {
  Eigen::Matrix3d axes;
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Eigen::Quaterniond wobble(Eigen::AngleAxisd(0.2, Eigen::Vector3d(1, 2, -1).normalized()));
  return {wobble * Eigen::Quaterniond(axes), {0.1, -0.2, 0.3}};
}

sextant::Scene TruthScene(const Camera& camera) {
  sextant::Scene scene;
  scene.cameras = {{.intrinsics = camera, .world_from_cam = WorldFromCamera()}};
  const Rigid3d cam_from_board{Eigen::Quaterniond(Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitY())),
                               {-0.3, 0.1, 2.0}};
  scene.boards = {{.board = {.top_right_m = 0.6, .right_bottom_m = 0.5},
                   .world_from_board = WorldFromCamera() * cam_from_board}};
  scene.walls = {{.name = "floor",
                  .world_from_wall = {Eigen::Quaterniond(Eigen::AngleAxisd(
                                          std::acos(-1.0), Eigen::Vector3d::UnitX())),
                                      {0.0, 0.0, -1.0}},
                  .width_m = 30.0,
                  .height_m = 30.0}};
  scene.boxes = {
      {.name = "box",
       .world_from_box = {Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ())),
                          {3.0, 0.6, -0.5}},
       .size_m = {0.4, 0.5, 0.6}}};
  scene.cylinders = {
      {.name = "pole", .base_in_world = {3.0, -0.9, -1.0}, .radius_m = 0.25, .height_m = 1.2}};
  return scene;
}

// Distance of a world point from the nearest surface of TruthScene with this outward normal, each
// computed from its own equation.
double DistanceToSurfaces(const sextant::Scene& scene, const Eigen::Vector3d& point,
                          const Eigen::Vector3d& normal) {
  constexpr double kNoMatch = 1e3;
  double nearest = kNoMatch;
  const auto consider = [&](double distance, const Eigen::Vector3d& expected) {
    if ((normal - expected).norm() < 1e-9) nearest = std::min(nearest, std::abs(distance));
  };
  const Rigid3d& board = scene.boards[0].world_from_board;
  consider((board.Inverse() * point).z(), board.rotation * -Eigen::Vector3d::UnitZ());
  consider(point.z() + 1.0, Eigen::Vector3d::UnitZ());
  const SceneBox& box = scene.boxes[0];
  const Eigen::Vector3d in_box = box.world_from_box.Inverse() * point;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      consider(in_box[axis] - 0.5 * side * box.size_m[axis],
               box.world_from_box.rotation * (side * Eigen::Vector3d::Unit(axis)));
    }
  }
  const SceneCylinder& pole = scene.cylinders[0];
  const Eigen::Vector3d across(point.x() - pole.base_in_world.x(),
                               point.y() - pole.base_in_world.y(), 0.0);
  consider(across.norm() - pole.radius_m, across.normalized());
  consider(point.z() - 0.2, Eigen::Vector3d::UnitZ());
  return nearest;
}

// The same lens before a quarter of the rows and columns.
Camera Coarser(Camera camera) {
  constexpr int kTimes = 4;
  camera.width_px /= kTimes;
  camera.height_px /= kTimes;
  camera.fx_px /= kTimes;
  camera.fy_px /= kTimes;
  camera.cx_px = (camera.cx_px + 0.5) / kTimes - 0.5;
  camera.cy_px = (camera.cy_px + 0.5) / kTimes - 0.5;
  return camera;
}

class CameraTruthTest : public testing::TestWithParam<std::string> {};

TEST_P(CameraTruthTest, DepthAndNormalMatchTheSurfaces) {
  constexpr int kStep = 2;
  const Camera camera = Coarser(*FindCameraModel(GetParam()));
  const sextant::Scene scene = TruthScene(camera);
  const Expected<SurfaceImage> surfaces = RenderSurfaces(scene, 0, 0.0);
  ASSERT_TRUE(surfaces);
  int seen = 0;
  for (int y = 0; y < camera.height_px; y += kStep) {
    for (int x = 0; x < camera.width_px; x += kStep) {
      const double depth = surfaces->depth_m.at<double>(y, x);
      if (depth == 0.0) continue;
      ++seen;
      const Eigen::Vector3d ray = *Unproject(camera, {1.0 * x, 1.0 * y});
      const auto& n = surfaces->normal_in_cam.at<cv::Vec3d>(y, x);
      const Eigen::Vector3d normal(n[0], n[1], n[2]);
      EXPECT_LT(normal.dot(ray), 0.0);
      const Rigid3d& world_from_cam = scene.cameras[0].world_from_cam;
      EXPECT_LT(DistanceToSurfaces(scene, world_from_cam * (ray * (depth / ray.z())),
                                   world_from_cam.rotation * normal),
                1e-9)
          << x << ", " << y;
    }
  }
  EXPECT_GT(seen, 0.1 * camera.width_px * camera.height_px / (kStep * kStep));
}

TEST_P(CameraTruthTest, InterpolatedRaysMatchTheLens) {
  const Camera camera = *FindCameraModel(GetParam());
  double worst = 0.0;
  for (const int left : {-1, camera.width_px / 3, camera.width_px - 33}) {
    for (const int top : {-1, camera.height_px / 2, camera.height_px - 33}) {
      const RayTile tile(camera, left, top);
      for (int row = 0; row < RayTile::kCorners; row += 3) {
        for (int column = 1; column < RayTile::kCorners; column += 3) {
          ASSERT_TRUE(tile.HasRay(row, column));
          const Eigen::Vector3d truth = *Unproject(camera, {left - 0.5 + column, top - 0.5 + row});
          worst = std::max(worst, (tile.Ray(row, column).normalized() - truth).norm());
        }
      }
    }
  }
  EXPECT_LT(worst, 1e-7);
}

INSTANTIATE_TEST_SUITE_P(Cameras, CameraTruthTest, testing::ValuesIn(CameraModelNames()),
                         [](const auto& camera) { return camera.param; });

// A lens model that folds over within the image has no rays beyond the fold, and valid rays are not
// affected.
TEST(RayTile, HasNoRaysOutsideOfTheLensImage) {
  const Camera camera{.model = CameraModel::kBrownConrady,
                      .width_px = 400,
                      .height_px = 400,
                      .fx_px = 200.0,
                      .fy_px = 200.0,
                      .cx_px = 200.0,
                      .cy_px = 200.0,
                      .distortion = {-0.3}};
  const RayTile corner(camera, 0, 0);
  EXPECT_FALSE(corner.HasRay(0, 0));
  sextant::Scene scene;
  scene.cameras = {{.intrinsics = camera}};
  const Expected<cv::Mat> image = RenderImage(scene, 0, {});
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->at<std::uint8_t>(0, 0), 0);
  EXPECT_EQ(image->at<std::uint8_t>(200, 200), 153);
}

TEST(TagPicture, IsAWindowOfTheWholeImage) {
  for (const std::string& model : CameraModelNames()) {
    TagPictureOptions options{.side_px = 90.0, .tilt_rad = 0.6, .camera_model = model, .seed = 3};
    const Expected<TagPicture> picture = RenderTagPicture(options);
    ASSERT_TRUE(picture) << picture.error().message;
    const Camera whole = *FindCameraModel(model);
    const int left = static_cast<int>(std::lround(whole.cx_px - picture->camera.cx_px));
    const int top = static_cast<int>(std::lround(whole.cy_px - picture->camera.cy_px));
    sextant::Scene scene;
    scene.cameras = {{.model = model}};
    scene.boards = {{.board = picture->board, .world_from_board = picture->cam_from_board}};
    scene.background_albedo = 0.3;
    const cv::Mat image = *RenderImage(scene, 0, {});
    const cv::Mat window =
        image(cv::Rect(left, top, picture->camera.width_px, picture->camera.height_px));
    // The blocks are at different positions, so the rays differ in their last digits.
    EXPECT_LE(cv::norm(window, picture->image, cv::NORM_INF), 1.0);
    for (const Eigen::Vector2d& corner : picture->corners_px) {
      EXPECT_GT(corner.minCoeff(), 8.0);
      EXPECT_LT(corner.x(), picture->camera.width_px - 9.0);
      EXPECT_LT(corner.y(), picture->camera.height_px - 9.0);
    }
    const Eigen::Vector3d sight = picture->cam_from_board.translation.normalized();
    const Eigen::Vector3d into = picture->cam_from_board.rotation * Eigen::Vector3d::UnitZ();
    EXPECT_NEAR(std::acos(sight.dot(into)), 0.6, 1e-9);
  }
}

TEST(TagPicture, RejectsInvalidOptions) {
  EXPECT_FALSE(RenderTagPicture({.side_px = 0.0}));
  EXPECT_FALSE(RenderTagPicture({.tilt_rad = 1.6}));
  EXPECT_FALSE(RenderTagPicture({.id = 4000}));
  EXPECT_FALSE(RenderTagPicture({.camera_model = "zed"}));
  const Expected<TagPicture> large = RenderTagPicture({.side_px = 2000.0});
  ASSERT_FALSE(large);
  EXPECT_EQ(large.error().code, ErrorCode::kInvalidInput);
}

}  // namespace
}  // namespace sextant::test
