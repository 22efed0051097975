// SPDX-License-Identifier: Apache-2.0
#include "report/overlay.h"

#include <gtest/gtest.h>

#include "support/pictures.h"

namespace sextant {
namespace {

const cv::Vec3b kBlack(0, 0, 0);

bool IsGrey(const cv::Vec3b& colour) {
  return colour[0] == colour[1] && colour[1] == colour[2] && colour != kBlack;
}
bool IsColoured(const cv::Vec3b& colour) { return colour[0] != colour[2]; }

// The camera looks along z, so that the pixel of a point 1 m away is (100 + 100 x, 100 + 100 y).
CalibrationProblem ProblemOfBothKinds() {
  CalibrationProblem problem;
  problem.camera = Camera{.width_px = 200,
                          .height_px = 200,
                          .fx_px = 100.0,
                          .fy_px = 100.0,
                          .cx_px = 100.0,
                          .cy_px = 100.0};
  for (const double x : {-0.5, 0.5}) {
    Pair3d3d points;
    points.point_in_cam = points.point_in_lidar = {x, 0.5, 1.0};
    problem.pairs_3d3d.push_back(points);
    Pair2d3d pixel;
    pixel.point_in_lidar = {x, -0.3, 1.0};
    pixel.pixel = {100.0 + 100.0 * x, 70.0};
    problem.pairs_2d3d.push_back(pixel);
  }
  return problem;
}

// The middle of each mark, where the lines of its cross meet.
struct MarkColours {
  cv::Vec3b points[2];
  cv::Vec3b pixels[2];
};

MarkColours ColoursFor(const DataNeeds& needs) {
  const std::string image = test::TestPath("black.png");
  const std::string out = test::TestPath("drawn.png");
  EXPECT_TRUE(test::WritePicture(image, cv::Mat(200, 200, CV_8UC3, cv::Scalar(0, 0, 0))));
  SolveReport report;
  report.inliers = {0};
  const Expected<void> drawn = DrawOverlay(ProblemOfBothKinds(), report, needs, image, out);
  EXPECT_TRUE(drawn) << drawn.error().message;
  const cv::Mat picture = test::ReadPicture(out);
  MarkColours colours;
  for (int i = 0; i < 2; ++i) {
    colours.points[i] = picture.at<cv::Vec3b>(150, i == 0 ? 50 : 150);
    colours.pixels[i] = picture.at<cv::Vec3b>(70, i == 0 ? 50 : 150);
  }
  return colours;
}

TEST(Overlay, InliersColourTheKindOfPairsThatTheSolverUses) {
  const MarkColours by_points = ColoursFor({.pairs_3d3d = 3});
  EXPECT_TRUE(IsGrey(by_points.points[1])) << "the second pair was left out";
  EXPECT_TRUE(IsColoured(by_points.points[0]));
  EXPECT_EQ(by_points.pixels[0], kBlack) << "not used";
  EXPECT_EQ(by_points.pixels[1], kBlack) << "not used";
  const MarkColours by_pixels = ColoursFor({.pairs_2d3d = 3});
  EXPECT_TRUE(IsGrey(by_pixels.pixels[1]));
  EXPECT_TRUE(IsColoured(by_pixels.pixels[0]));
  EXPECT_EQ(by_pixels.points[0], kBlack) << "not used";
}

}  // namespace
}  // namespace sextant
