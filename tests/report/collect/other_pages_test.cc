// SPDX-License-Identifier: Apache-2.0
// The pages of a rig, of a check and of a capture that has nothing yet.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "report/collect/check_page.h"
#include "report/collect/live_page.h"
#include "report/collect/rig_page.h"
#include "report/page/page_html.h"
#include "support/run_program.h"

namespace sextant {
namespace {

using testing::HasSubstr;
using testing::Not;

RigResult TwoCamerasAndALidar() {
  RigResult rig{.version = "1", .root = "left"};
  const Camera camera{.width_px = 640,
                      .height_px = 480,
                      .fx_px = 500,
                      .fy_px = 500,
                      .cx_px = 319.5,
                      .cy_px = 239.5};
  const Matrix6d covariance = 1e-6 * Matrix6d::Identity();
  rig.sensors = {
      {.name = "left", .camera = camera, .root_from_sensor = Rigid3d{}},
      {.name = "right",
       .camera = camera,
       .root_from_sensor = Rigid3d{Eigen::Quaterniond::Identity(), {0.5, 0, 0}},
       .covariance = covariance},
      {.name = "top",
       .root_from_sensor = Rigid3d{Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), {0.2, -0.1, 0}},
       .covariance = covariance}};
  rig.pairs = {{.a = "left",
                .b = "right",
                .a_from_b = *rig.sensors[1].root_from_sensor,
                .covariance = covariance,
                .views = 4,
                .alone_a_from_b = rig.sensors[1].root_from_sensor,
                .alone_covariance = covariance,
                .alone_sigmas = 0.4}};
  rig.views = {{.moment = "000", .board = 3, .seen = {{.sensor = "left", .used = true, .rms = 1}}}};
  rig.numbers = {{.sensor = "top", .name = "range_offset_m", .value = 0.01, .sigma = 0.002}};
  return rig;
}

TEST(RigPage, ShowsSensorsPairsAndBoards) {
  const std::string html = FormatPage(CollectRigPage(TwoCamerasAndALidar()));
  for (const char* part :
       {"Rig report", "NO FAULT FOUND", "left, right, top", "left_from_right", "range_offset_m",
        "id=\"pairs\"", "id=\"boards\"", "class=\"top-view\"", "3D sensor"}) {
    EXPECT_THAT(html, HasSubstr(part)) << part;
  }
  EXPECT_THAT(html, Not(HasSubstr("id=\"views\"")));
}

TEST(RigPage, ItsVerdictIsNeverBetterThanWhatWasChecked) {
  RigResult rig = TwoCamerasAndALidar();
  EXPECT_EQ(CollectRigPage(rig).verdict.tone, PageTone::kGood);
  rig.pairs[0].alone_sigmas.reset();
  EXPECT_EQ(CollectRigPage(rig).verdict.word, "NOT CHECKED");
  rig.pairs[0].alone_sigmas = 3.5;
  EXPECT_EQ(CollectRigPage(rig).verdict.word, "USABLE WITH CARE");
  rig.pairs[0].alone_sigmas = 0.5;
  rig.warnings = {"a board bends"};
  EXPECT_EQ(CollectRigPage(rig).verdict.word, "USABLE WITH CARE");
  rig.unconnected = {"rear sees no board with another sensor"};
  EXPECT_EQ(CollectRigPage(rig).verdict.word, "USABLE WITH CARE");
  EXPECT_THAT(CollectRigPage(rig).verdict.reason, HasSubstr(rig.unconnected[0]));
  rig.refutations = {"the print is small"};
  EXPECT_EQ(CollectRigPage(rig).verdict.word, "NOT USABLE");
  EXPECT_EQ(CollectRigPage(rig).verdict.reason, "the print is small");
}

TEST(CheckPage, StatesTheChangeWithItsSigmaOrThatThereIsNone) {
  CheckResult check{.version = "1",
                    .pose_path = "result.yaml",
                    .state = "moved",
                    .reason = "moved by 1.15 deg.",
                    .pairs = {{"7", "nowhere.png", "nowhere.pcd"}},
                    .detect_rad = 0.01,
                    .detect_m = 0.08};
  check.change << 0.02, 0.0, 0.0, 0.01, 0.0, 0.0;
  check.sigma = Vector6d::Constant(1e-3);
  const std::string html = FormatPage(CollectCheckPage(check, test::TestFolder()));
  EXPECT_THAT(html, HasSubstr("<strong>MOVED</strong>\n<p>moved by 1.15 deg.</p>"));
  EXPECT_THAT(html, HasSubstr("1.146 ± 0.057 deg"));
  EXPECT_THAT(html, HasSubstr("verdict bad"));
  check.sigma.reset();
  check.state = "cannot tell";
  const std::string unknown = FormatPage(CollectCheckPage(check, test::TestFolder()));
  EXPECT_THAT(unknown, HasSubstr("No change is stated"));
  EXPECT_THAT(unknown, HasSubstr("verdict neutral"));
  EXPECT_THAT(unknown, Not(HasSubstr("1.146")));
}

TEST(LivePage, WithoutAPairItStatesWhereToBegin) {
  const ReportPage page =
      CollectLivePage({.boards = {Board{.id = 4, .top_right_m = 0.6, .right_bottom_m = 0.45}},
                       .live = {.revision = "1", .state = "Waiting"}});
  EXPECT_EQ(page.verdict.word, "NOTHING YET");
  EXPECT_THAT(page.next.sentences.front(), HasSubstr("board 4 (0.60 x 0.45 m) 1.2 to 3 m away"));
  EXPECT_THAT(FormatPage(page), HasSubstr("Waiting"));
}

}  // namespace
}  // namespace sextant
