// SPDX-License-Identifier: Apache-2.0
#include "report/advice_picture.h"

#include <gtest/gtest.h>

namespace sextant {
namespace {

// Heights and widths that are rounded up, among them those of a phone that is held upright.
TEST(AdvicePicture, CamerasOfEveryShapeAreDrawn) {
  struct Size {
    int width_px;
    int height_px;
  };
  for (const Size& size : {Size{640, 480}, Size{1080, 1920}, Size{1200, 1920}, Size{1080, 2400},
                           Size{1920, 300}, Size{480, 640}, Size{1000, 1001}}) {
    CalibrationResult result;
    result.boards = {Board{.id = 0, .top_right_m = 0.6, .right_bottom_m = 0.45}};
    const SensorPair sensors{.camera = {.width_px = size.width_px,
                                        .height_px = size.height_px,
                                        .fx_px = 900.0,
                                        .fy_px = 900.0,
                                        .cx_px = 0.5 * size.width_px,
                                        .cy_px = 0.5 * size.height_px}};
    const BoardProposal proposal{
        .cam_from_board = {Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.0, 0.0, 2.0)}};
    cv::Mat picture;
    EXPECT_NO_THROW(picture = DrawAdvice(result, sensors, {proposal}))
        << size.width_px << " x " << size.height_px;
    EXPECT_EQ(picture.rows, 620) << size.width_px << " x " << size.height_px;
  }
}

}  // namespace
}  // namespace sextant
