// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "simulator/camera/render.h"
#include "simulator/scene/camera_model.h"
#include "support/edge_fit.h"
#include "support/one_board_scene.h"

namespace sextant::test {
namespace {

Camera SmallCamera(CameraModel model) {
  Camera camera{.model = model,
                .width_px = 256,
                .height_px = 192,
                .fx_px = 180.0,
                .fy_px = 181.0,
                .cx_px = 126.3,
                .cy_px = 97.1};
  if (model == CameraModel::kBrownConrady) camera.distortion = {-0.17, 0.023, 0.0004, -0.0003};
  if (model == CameraModel::kEquidistant) camera.distortion = {-0.054, -0.078, 0.096, -0.052};
  return camera;
}

// A wide board with its right edge in the image, rotated and shifted.
Rigid3d EdgePose(double angle_rad, double shift_px) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()));
  const double metre_per_px = 1.0 / 180.0;
  const Eigen::Vector3d edge_center((20.0 + shift_px) * metre_per_px, 0.0, 1.0);
  return {turn, edge_center - turn * Eigen::Vector3d(0.5, 0.0, 0.0)};
}

// The intersection of the true edge with the line (row or column) of a measured point, by
// bisection.
double TrueCrossing(const Camera& camera, const Rigid3d& pose, const Eigen::Vector2d& measured,
                    int down) {
  const auto pixel_at = [&](double y) {
    return *Project(camera, pose * Eigen::Vector3d(0.5, y, 0));
  };
  double low = -0.35;
  double high = 0.35;
  const bool grows = pixel_at(high)[down] > pixel_at(low)[down];
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    ((pixel_at(middle)[down] < measured[down]) == grows ? low : high) = middle;
  }
  return pixel_at(low)[1 - down];
}

// White on black: a step of 230 grey levels.
Expected<cv::Mat> RenderEdge(const Camera& camera, const Rigid3d& pose,
                             const ImageOptions& options) {
  sextant::Scene scene = OneBoardScene(camera, {.top_right_m = 1.0, .right_bottom_m = 0.7}, pose);
  scene.background_albedo = 20.0 / 255.0;
  return RenderImage(scene, 0, options);
}

class EdgeTest : public testing::TestWithParam<CameraModel> {};

TEST_P(EdgeTest, IsAccurateToAHundredthOfAPixel) {
  const Camera camera = SmallCamera(GetParam());
  double worst_line = 0.0;
  double worst_mean = 0.0;
  for (const double angle_deg :
       {0.0, 0.3, 7.0, 26.565, 31.7, 45.0, 58.3, 63.435, 89.8, 90.0, 123.0}) {
    for (const double shift_px : {0.0, 0.13, 0.37, 0.5}) {
      const Rigid3d pose = EdgePose(angle_deg * std::numbers::pi / 180.0, shift_px);
      const auto image = RenderEdge(camera, pose, EvenLight());
      ASSERT_TRUE(image) << image.error().message;
      const Eigen::Vector2d from = *Project(camera, pose * Eigen::Vector3d(0.5, -0.3, 0.0));
      const Eigen::Vector2d to = *Project(camera, pose * Eigen::Vector3d(0.5, 0.3, 0.0));
      const int down = std::abs(to.y() - from.y()) >= std::abs(to.x() - from.x()) ? 1 : 0;
      const std::vector<Eigen::Vector2d> points = EdgeCrossings(*image, from, to, 7);
      ASSERT_GT(points.size(), 50U);
      double sum = 0.0;
      for (const Eigen::Vector2d& point : points) {
        const double miss = point[1 - down] - TrueCrossing(camera, pose, point, down);
        worst_line = std::max(worst_line, std::abs(miss));
        sum += miss;
      }
      const double mean = sum / static_cast<double>(points.size());
      worst_mean = std::max(worst_mean, std::abs(mean));
      EXPECT_LT(std::abs(mean), 0.002) << angle_deg << " deg, shift " << shift_px;
    }
  }
  // A line has up to three edge pixels, each rounded by up to half a grey level of 230.
  EXPECT_LT(worst_line, 1.5 / 230.0);
  RecordProperty("worst_line_px", std::to_string(worst_line));
  RecordProperty("worst_mean_px", std::to_string(worst_mean));
}

INSTANTIATE_TEST_SUITE_P(Lenses, EdgeTest,
                         testing::Values(CameraModel::kPinhole, CameraModel::kBrownConrady,
                                         CameraModel::kEquidistant));

TEST(EdgeTest, TheTestDetectsAnErrorOfTwoHundredthsOfAPixel) {
  const Camera camera = SmallCamera(CameraModel::kPinhole);
  const auto crossing = [&](double shift_px) {
    const Rigid3d pose = EdgePose(0.0, shift_px);
    const auto image = RenderEdge(camera, pose, EvenLight());
    return EdgeCrossings(*image, {146.3, 50.0}, {146.3, 140.0}, 7).front().x();
  };
  EXPECT_NEAR(crossing(0.02) - crossing(0.0), 0.02, 0.008);
}

TEST(EdgeTest, IsNotShiftedByBlur) {
  const Camera camera = SmallCamera(CameraModel::kPinhole);
  const Rigid3d pose = EdgePose(0.4, 0.2);
  ImageOptions options = EvenLight();
  options.blur_sigma_px = 0.7;
  const auto image = RenderEdge(camera, pose, options);
  ASSERT_TRUE(image);
  const Eigen::Vector2d from = *Project(camera, pose * Eigen::Vector3d(0.5, -0.2, 0.0));
  const Eigen::Vector2d to = *Project(camera, pose * Eigen::Vector3d(0.5, 0.2, 0.0));
  double sum = 0.0;
  const std::vector<Eigen::Vector2d> points = EdgeCrossings(*image, from, to, 9);
  for (const Eigen::Vector2d& point : points) {
    sum += point.x() - TrueCrossing(camera, pose, point, 1);
  }
  EXPECT_NEAR(sum / static_cast<double>(points.size()), 0.0, 0.005);
}

}  // namespace
}  // namespace sextant::test
