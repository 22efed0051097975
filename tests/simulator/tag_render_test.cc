// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "features/camera/tags/apriltag_family.h"
#include "features/camera/tags/aruco_dictionary.h"
#include "features/camera/tags/opencv_aruco.h"
#include "features/camera/tags/tag_pattern.h"
#include "simulator/camera/render.h"
#include "simulator/scene/camera_model.h"
#include "support/edge_fit.h"
#include "support/one_board_scene.h"

namespace sextant::test {
namespace {

using Points = std::vector<Eigen::Vector2d>;

Rigid3d Pose(double yaw, double pitch, double roll, const Eigen::Vector3d& at) {
  const Eigen::AngleAxisd about_y(yaw, Eigen::Vector3d::UnitY());
  const Eigen::AngleAxisd about_x(pitch, Eigen::Vector3d::UnitX());
  const Eigen::AngleAxisd about_z(roll, Eigen::Vector3d::UnitZ());
  return {about_y * about_x * about_z, at};
}

Board BoardWith(const BoardTag& tag) {
  return {.top_right_m = 0.6, .right_bottom_m = 0.5, .tags = {tag}};
}

// The reported corners in the image, clockwise from the tag's own top-left.
Points TrueCorners(const Camera& camera, const Rigid3d& cam_from_board, const BoardTag& tag) {
  const Eigen::Rotation2Dd turn(tag.rotation_rad);
  const double half = 0.5 * tag.edge_m;
  Points corners;
  for (const Eigen::Vector2d& corner :
       {Eigen::Vector2d(-half, -half), Eigen::Vector2d(half, -half), Eigen::Vector2d(half, half),
        Eigen::Vector2d(-half, half)}) {
    const Eigen::Vector2d in_board = tag.center_in_board_m + turn * corner;
    corners.push_back(
        *Project(camera, cam_from_board * Eigen::Vector3d(in_board.x(), in_board.y(), 0)));
  }
  return corners;
}

// The part of the camera's image around these pixels.
Camera WindowAround(Camera camera, const Points& pixels) {
  constexpr double kMargin_px = 12.0;
  Eigen::Array2d low = pixels[0];
  Eigen::Array2d high = pixels[0];
  for (const Eigen::Vector2d& pixel : pixels) {
    low = low.min(pixel.array());
    high = high.max(pixel.array());
  }
  low = (low - kMargin_px).floor();
  high = (high + kMargin_px).ceil();
  EXPECT_GE(low.minCoeff(), 0.0);
  EXPECT_LT(high.x(), camera.width_px);
  EXPECT_LT(high.y(), camera.height_px);
  camera.cx_px -= low.x();
  camera.cy_px -= low.y();
  camera.width_px = static_cast<int>(high.x() - low.x()) + 1;
  camera.height_px = static_cast<int>(high.y() - low.y()) + 1;
  return camera;
}

class TagCornerTest : public testing::TestWithParam<std::string> {};

// Only the window of the tag is rendered (see TagPicture.IsAWindowOfTheWholeImage). Frontal, tilted
// in both directions, one corner up, near the image border.
TEST_P(TagCornerTest, IsAtItsProjection) {
  const Camera camera = *FindCameraModel(GetParam());
  const BoardTag tag{.family = "aruco_original",
                     .id = 26,
                     .edge_m = 0.205,
                     .center_in_board_m = {0.03, -0.02},
                     .rotation_rad = 0.2};
  const double z = camera.fx_px * 0.205 / 130.0;
  const double x = 0.3 * camera.width_px / camera.fx_px * z;
  const double y = 0.25 * camera.height_px / camera.fy_px * z;
  double worst = 0.0;
  for (const Rigid3d& pose :
       {Pose(0.0, 0.0, -0.2, {0.01, 0.02, z}), Pose(0.7, 0.1, 0.785, {x, -y, z}),
        Pose(-0.3, 0.9, 0.3, {-x, y, z}), Pose(-0.5, -0.5, 1.9, {x, y, 1.1 * z})}) {
    const Camera window = WindowAround(camera, TrueCorners(camera, pose, tag));
    const auto image = RenderImage(OneBoardScene(window, BoardWith(tag), pose), 0, EvenLight());
    ASSERT_TRUE(image) << image.error().message;
    const Points truth = TrueCorners(window, pose, tag);
    const Points fitted = FitQuadCorners(*image, truth, 5);
    for (std::size_t i = 0; i < 4; ++i) {
      const double miss = (fitted[i] - truth[i]).norm();
      worst = std::max(worst, miss);
      EXPECT_LT(miss, 0.02) << "corner " << i << " at " << truth[i].transpose();
    }
  }
  RecordProperty("worst_px", std::to_string(worst));
}

INSTANTIATE_TEST_SUITE_P(Cameras, TagCornerTest, testing::ValuesIn(CameraModelNames()),
                         [](const auto& family) { return family.param; });

struct Found {
  int id = -1;
  Points corners;  // Clockwise from the tag's top-left, in our pixel convention.
};

std::vector<Found> FindAruco(const cv::Mat& image, const cv::aruco::Dictionary& dictionary,
                             int border_cells) {
  cv::aruco::DetectorParameters parameters = ArucoParameters();
  parameters.markerBorderBits = border_cells;
  std::vector<Found> found;
  for (const OpenCvTag& tag : DetectAruco(image, dictionary, parameters)) {
    found.push_back({.id = tag.id, .corners = {}});
    for (const cv::Point2f& corner : tag.corners_px)
      found.back().corners.emplace_back(corner.x, corner.y);
  }
  return found;
}

std::vector<Found> FindAprilTag(const cv::Mat& image, apriltag_family_t* family) {
  const std::unique_ptr<apriltag_detector_t, void (*)(apriltag_detector_t*)> detector(
      apriltag_detector_create(), apriltag_detector_destroy);
  detector->quad_decimate = 1.0F;
  // Without bit correction: the tables for two bits take gigabytes for families of 50 thousand
  // tags.
  apriltag_detector_add_family_bits(detector.get(), family, 0);
  cv::Mat copy = image.clone();
  image_u8_t view = {copy.cols, copy.rows, static_cast<std::int32_t>(copy.step), copy.data};
  const std::unique_ptr<zarray_t, void (*)(zarray_t*)> detections(
      apriltag_detector_detect(detector.get(), &view), apriltag_detections_destroy);
  std::vector<Found> found;
  for (int i = 0; i < zarray_size(detections.get()); ++i) {
    apriltag_detection_t* detection = nullptr;
    zarray_get(detections.get(), i, &detection);
    found.push_back({.id = detection->id, .corners = {}});
    // Anticlockwise from the bottom-left; pixel (0, 0) is the image's corner.
    for (const int corner : {3, 2, 1, 0}) {
      found.back().corners.emplace_back(detection->p[corner][0] - 0.5,
                                        detection->p[corner][1] - 0.5);
    }
  }
  apriltag_detector_remove_family(detector.get(), family);
  return found;
}

class TagFamilyTest : public testing::TestWithParam<std::string> {};

TEST_P(TagFamilyTest, IsDetectedByItsLibraryInARenderedImage) {
  const std::string& family = GetParam();
  const Camera camera{.width_px = 300,
                      .height_px = 260,
                      .fx_px = 500.0,
                      .fy_px = 500.0,
                      .cx_px = 149.0,
                      .cy_px = 131.0};
  const Rigid3d pose = Pose(0.3, -0.2, 0.15, {0.0, 0.0, 1.0});
  for (const int id : {0, *TagCount(family) - 1}) {
    const int cells = MakeTagPattern(family, id)->cells;
    const int edge_cells = MakeTagPattern(family, id)->edge_cells;
    const BoardTag tag{.family = family, .id = id, .edge_m = 0.3 * edge_cells / cells};
    ImageOptions options = EvenLight();
    options.blur_sigma_px = 0.5;
    const auto image = RenderImage(OneBoardScene(camera, BoardWith(tag), pose), 0, options);
    ASSERT_TRUE(image) << image.error().message;
    const auto aruco = FindArucoDictionary(family);
    const AprilTagFamily april = MakeAprilTagFamily(family);
    const std::vector<Found> found = aruco ? FindAruco(*image, *aruco, ArucoBorderCells(family))
                                           : FindAprilTag(*image, april.get());
    ASSERT_EQ(found.size(), 1U) << family << " " << id;
    EXPECT_EQ(found[0].id, id);
    const Points truth = TrueCorners(camera, pose, tag);
    // Without refinement ArUco's corners are whole pixels; a cell has about twelve pixels.
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_LT((found[0].corners[i] - truth[i]).norm(), aruco ? 2.0 : 0.5) << family << " " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Families, TagFamilyTest, testing::ValuesIn(TagFamilies()),
                         [](const auto& family) { return family.param; });

}  // namespace
}  // namespace sextant::test
