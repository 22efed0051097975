// SPDX-License-Identifier: Apache-2.0
#include "cli/mark/mark_controller.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/mark/mark_canvas.h"

namespace sextant::cli {
namespace {

using testing::HasSubstr;

constexpr int kWindowWidth = 1280;
constexpr int kWindowHeight = 800;
constexpr double kFitScale = (800.0 - 2.0 * kMarkBar_px) / 1200.0;

MarkController NewController(bool has_photo = true) {
  std::vector<ProjectedReturn> returns;
  for (int u = 0; u < 1920; u += 4) {
    returns.push_back({.pixel = {u, 600}, .range_m = 1.0 + u / 200.0, .ring = 0});
  }
  return MarkController(MarkSession(returns, {.camera = AssumedCamera(1920, 1200)}),
                        MarkViewport(kWindowWidth, kWindowHeight, kMarkBar_px, 1920, 1200),
                        has_photo);
}

void Click(MarkController& controller, const Eigen::Vector2d& at) {
  controller.Move(at);
  controller.LeftDown(at);
  controller.LeftUp(at);
}

TEST(MarkViewport, ShowsTheWholePictureBetweenTheBars) {
  const MarkViewport view(kWindowWidth, kWindowHeight, kMarkBar_px, 1920, 1200);
  EXPECT_DOUBLE_EQ(view.scale(), kFitScale);
  const Eigen::Vector2d top_left = view.ToCanvas({-0.5, -0.5});
  const Eigen::Vector2d bottom_right = view.ToCanvas({1919.5, 1199.5});
  EXPECT_NEAR(top_left.y(), kMarkBar_px - 0.5, 1e-9);
  EXPECT_NEAR(bottom_right.y(), kWindowHeight - kMarkBar_px - 0.5, 1e-9);
  EXPECT_NEAR(top_left.x() + bottom_right.x(), kWindowWidth - 1.0, 1e-9);
}

TEST(MarkViewport, ZoomKeepsWhatIsUnderThePointer) {
  MarkViewport view(kWindowWidth, kWindowHeight, kMarkBar_px, 1920, 1200);
  const Eigen::Vector2d at(900.0, 300.0);
  const Eigen::Vector2d pixel = view.ToPixel(at);
  for (int i = 0; i < 40; ++i) {
    view.ZoomAt(at, 1.5);
    EXPECT_LT((view.ToPixel(at) - pixel).norm(), 1e-9);
  }
  EXPECT_DOUBLE_EQ(view.scale(), 64.0);
  view.Fit();
  EXPECT_DOUBLE_EQ(view.scale(), kFitScale);
}

TEST(MarkViewport, SomeOfThePictureStaysInView) {
  MarkViewport view(kWindowWidth, kWindowHeight, kMarkBar_px, 1920, 1200);
  view.Pan({1e6, -1e6});
  const Eigen::Vector2d left_bottom = view.ToCanvas({-0.5, 1199.5});
  EXPECT_LT(left_bottom.x(), kWindowWidth);
  EXPECT_GT(left_bottom.y(), 0.0);
}

TEST(MarkController, AClickMarksThePixelUnderThePointerAtAnyZoom) {
  MarkController controller = NewController();
  const Eigen::Vector2d at(700.0, 300.0);
  Click(controller, at);
  controller.Wheel(at, true);
  controller.Wheel(at, true);
  controller.Press('+');
  Click(controller, at);
  const std::vector<Eigen::Vector2d>& clicks = controller.session().marks().unfinished;
  ASSERT_EQ(clicks.size(), 2U);
  EXPECT_EQ(clicks[0], clicks[1]);
  EXPECT_LT((clicks[0] - controller.viewport().ToPixel(at)).norm(), 0.01);
  EXPECT_DOUBLE_EQ(controller.viewport().scale(), kFitScale * 1.25 * 1.25 * 1.5);
}

TEST(MarkController, DraggingMovesThePictureAndMarksNothing) {
  MarkController controller = NewController();
  const Eigen::Vector2d at(700.0, 300.0);
  const Eigen::Vector2d by(40.0, -20.0);
  const Eigen::Vector2d pixel = controller.viewport().ToPixel(at);
  controller.LeftDown(at);
  controller.Move(at + Eigen::Vector2d(3.0, 10.0));
  controller.Move(at + by);
  controller.LeftUp(at + by);
  EXPECT_TRUE(controller.session().marks().unfinished.empty());
  EXPECT_LT((controller.viewport().ToCanvas(pixel) - at - by).norm(), 1e-9);
  controller.Move(at);  // The button is up: nothing moves.
  EXPECT_LT((controller.viewport().ToCanvas(pixel) - at - by).norm(), 1e-9);
  controller.LeftDown(at);
  controller.Move(at + Eigen::Vector2d(2.0, 1.0));  // A click by a trembling hand.
  controller.LeftUp(at + Eigen::Vector2d(2.0, 1.0));
  EXPECT_EQ(controller.session().marks().unfinished.size(), 1U);
}

TEST(MarkController, RightClickAndKeysUndo) {
  MarkController controller = NewController();
  for (int i = 0; i < 3; ++i) Click(controller, {500.0 + 50.0 * i, 300.0});
  controller.RightDown();
  EXPECT_EQ(controller.session().marks().unfinished.size(), 2U);
  controller.Press('u');
  EXPECT_EQ(controller.session().marks().unfinished.size(), 1U);
  controller.Press('r');
  EXPECT_EQ(controller.session().marks().unfinished.size(), 2U);
}

TEST(MarkController, QuittingWithoutSavingAsksOnce) {
  MarkController controller = NewController();
  EXPECT_EQ(controller.Press('q'), MarkRequest::kQuit);  // Nothing to lose.
  Click(controller, {500.0, 300.0});
  EXPECT_EQ(controller.Press('q'), MarkRequest::kNone);
  EXPECT_THAT(controller.message(), HasSubstr("Not saved"));
  controller.Press('f');  // Another key takes the question back.
  EXPECT_EQ(controller.Press('q'), MarkRequest::kNone);
  EXPECT_EQ(controller.Press('q'), MarkRequest::kQuit);
  EXPECT_EQ(controller.Press('s'), MarkRequest::kSave);
  controller.ShowMessage("saved", true);
  EXPECT_EQ(controller.message(), "saved");
  EXPECT_EQ(controller.Press(27), MarkRequest::kQuit);
}

TEST(MarkController, WithoutAPhotoThereAreNoCornersToClick) {
  MarkController controller = NewController(false);
  controller.Press('c');
  EXPECT_EQ(controller.session().mode(), MarkMode::kEdges);
  EXPECT_THAT(controller.message(), HasSubstr("--image"));
  controller.Press('v');
  EXPECT_EQ(controller.layers(), MarkLayers::kBoth);
}

TEST(MarkController, TheViewGoesRoundItsLayers) {
  MarkController controller = NewController();
  for (const MarkLayers layers : {MarkLayers::kScan, MarkLayers::kPhoto, MarkLayers::kBoth}) {
    controller.Press('v');
    EXPECT_EQ(controller.layers(), layers);
  }
}

// Whether something bright is drawn within two pixels.
bool IsDrawnAt(const cv::Mat& canvas, const Eigen::Vector2d& at) {
  for (int y = cvRound(at.y()) - 2; y <= cvRound(at.y()) + 2; ++y) {
    for (int x = cvRound(at.x()) - 2; x <= cvRound(at.x()) + 2; ++x) {
      const cv::Vec3b& c = canvas.at<cv::Vec3b>(y, x);
      if (c[0] > 120 || c[1] > 120 || c[2] > 120) return true;
    }
  }
  return false;
}

TEST(MarkCanvas, ReturnsAreDrawnWhereTheViewportPutsThem) {
  MarkController controller = NewController(false);
  MarkCanvas canvas{cv::Mat()};
  for (const bool zoomed : {false, true}) {
    if (zoomed) controller.Wheel({800.0, 400.0}, true);
    const cv::Mat drawn = canvas.Draw(controller);
    ASSERT_EQ(drawn.size(), cv::Size(kWindowWidth, kWindowHeight));
    EXPECT_TRUE(IsDrawnAt(drawn, controller.viewport().ToCanvas({960.0, 600.0})));
    EXPECT_FALSE(IsDrawnAt(drawn, controller.viewport().ToCanvas({960.0, 500.0})));
  }
}

TEST(MarkCanvas, ClicksAndEdgesAreDrawn) {
  MarkController controller = NewController(false);
  MarkCanvas canvas{cv::Mat()};
  const cv::Mat before = canvas.Draw(controller);
  Click(controller, {500.0, 200.0});
  controller.Move({10.0, 100.0});
  EXPECT_FALSE(IsDrawnAt(before, {500.0, 200.0}));
  EXPECT_TRUE(IsDrawnAt(canvas.Draw(controller), {500.0, 200.0}));
  Click(controller, {600.0, 200.0});
  Click(controller, {600.0, 300.0});
  Click(controller, {500.0, 300.0});
  controller.Move({10.0, 100.0});
  const cv::Mat after = canvas.Draw(controller);
  EXPECT_TRUE(IsDrawnAt(after, {550.0, 200.0}));  // Its outline.
  EXPECT_FALSE(IsDrawnAt(after, {500.0, 150.0}));
}

TEST(MarkCanvas, APhotoIsShownPixelOnPixel) {
  cv::Mat photo(1200, 1920, CV_8UC3, cv::Scalar(0, 0, 0));
  photo(cv::Rect(900, 300, 40, 40)).setTo(cv::Scalar(255, 255, 255));
  MarkController controller = NewController();
  controller.Press('v');
  controller.Press('v');  // The photo alone.
  controller.Wheel({640.0, 300.0}, true);
  MarkCanvas canvas{photo};
  const cv::Mat drawn = canvas.Draw(controller);
  const MarkViewport& view = controller.viewport();
  EXPECT_TRUE(IsDrawnAt(drawn, view.ToCanvas({902.0, 302.0})));
  EXPECT_TRUE(IsDrawnAt(drawn, view.ToCanvas({937.0, 337.0})));
  EXPECT_FALSE(IsDrawnAt(drawn, view.ToCanvas({894.0, 320.0})));
  EXPECT_FALSE(IsDrawnAt(drawn, view.ToCanvas({945.0, 320.0})));
  EXPECT_FALSE(IsDrawnAt(drawn, view.ToCanvas({960.0, 600.0})));  // No scan over it.
}

}  // namespace
}  // namespace sextant::cli
