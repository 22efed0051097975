// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "e2e/run_sextant.h"
#include "e2e/shared_session.h"
#include "e2e/swinging_scene.h"
#include "support/real_data.h"
#include "support/run_program.h"
#include "support/scratch_folder.h"

namespace sextant {
namespace {

using nlohmann::json;
using test::ProgramRun;
using test::RunSextant;
using test::TestPath;
using testing::HasSubstr;

constexpr const char* kCameras = R"(  - name: left
    intrinsics: {model: pinhole, width_px: 960, height_px: 600, fx_px: 560, fy_px: 560, cx_px: 479.5, cy_px: 299.5}
    pose: {position_m: [0.05, 0.2, 0.92], yaw_deg: 2, pitch_deg: 1, roll_deg: -1}
  - name: right
    intrinsics: {model: pinhole, width_px: 960, height_px: 600, fx_px: 560, fy_px: 560, cx_px: 479.5, cy_px: 299.5}
    pose: {position_m: [0.05, -0.2, 0.92], yaw_deg: -2, pitch_deg: 0, roll_deg: 1}
)";

std::filesystem::path SessionOfRig() {
  return test::SharedSession(test::SwingingScene("rig", kCameras), "--interval 60 --scans 3");
}

// The session solved as a rig, with the problem that it wrote.
struct SolvedRig {
  test::ScratchFolder folder{};
  std::string out = (folder.path() / "rig.json").string();
  std::string problem = (folder.path() / "rig.yaml").string();
  ProgramRun run = RunSextant("calibrate " + SessionOfRig().string() + " --out " + out +
                              " --problem " + problem);
};

// Once per process; tests do not change it.
const SolvedRig& Solved() {
  static const SolvedRig solved;
  return solved;
}

TEST(RigCommand, ASessionOfSeveralCamerasIsSolvedAsOneRig) {
  const ProgramRun& run = Solved().run;
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("left_from_right"));
  const json rig = json::parse(test::ReadText(Solved().out));
  ASSERT_EQ(rig["sensors"].size(), 3U);
  for (const json& sensor : rig["sensors"]) {
    const auto at = sensor["root_from_sensor"]["translation_m"].get<std::vector<double>>();
    const auto truth = sensor["true_root_from_sensor"]["translation_m"].get<std::vector<double>>();
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(at[k], truth[k], 0.02) << sensor["name"];
    EXPECT_GE(sensor["views_used"].get<int>(), 4) << sensor["name"];
  }
  ASSERT_EQ(rig["pairs"].size(), 3U);
  for (const json& pair : rig["pairs"]) {
    EXPECT_LT(pair["alone"]["off_sigmas"].get<double>(), 3.0) << pair["a"] << pair["b"];
  }
  // The problem that it wrote has the same answer.
  const ProgramRun again =
      RunSextant("rig " + Solved().problem + " --out " + TestPath("again.json"));
  ASSERT_EQ(again.exit_code, 0) << again.err;
  const json same = json::parse(test::ReadText(TestPath("again.json")));
  for (std::size_t s = 0; s < 3; ++s) {
    for (std::size_t k = 0; k < 3; ++k) {
      const char* key = "root_from_sensor";
      EXPECT_NEAR(same["sensors"][s][key]["translation_m"][k].get<double>(),
                  rig["sensors"][s][key]["translation_m"][k].get<double>(), 1e-6);
    }
  }
}

TEST(RigCommand, ARigIsExportedAsATreeOrAPair) {
  const std::string& out = Solved().out;
  ASSERT_EQ(Solved().run.exit_code, 0);
  const ProgramRun tree = RunSextant("export " + out + " --to ros2");
  ASSERT_EQ(tree.exit_code, 0) << tree.err;
  EXPECT_THAT(tree.out, HasSubstr("'--child-frame-id', 'right'"));
  EXPECT_THAT(tree.out, HasSubstr("'--child-frame-id', 'left'"));
  const ProgramRun pair = RunSextant("export " + out + " --sensors left lidar --to matrix");
  ASSERT_EQ(pair.exit_code, 0) << pair.err;
  EXPECT_THAT(pair.out, HasSubstr("left"));
  const ProgramRun none = RunSextant("export " + out + " --sensors left top --to matrix");
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("there are: lidar, left, right"));
}

TEST(RigCommand, AWrongSizeOfTheTagIsNotUsable) {
  const std::string out = TestPath("wrong.json");
  ASSERT_EQ(Solved().run.exit_code, 0);
  std::string text = test::ReadText(Solved().problem);
  // The printed points as if the tags were a quarter larger.
  const std::string corners =
      "[-0.1025, -0.1025, 0.1025, -0.1025, 0.1025, 0.1025, -0.1025, 0.1025]";
  const std::string larger = "[-0.128, -0.128, 0.128, -0.128, 0.128, 0.128, -0.128, 0.128]";
  for (std::size_t at = text.find(corners); at != std::string::npos; at = text.find(corners)) {
    text.replace(at, corners.size(), larger);
  }
  ASSERT_NE(text, test::ReadText(Solved().problem));
  const std::string wrong = TestPath("wrong.yaml");
  std::ofstream(wrong) << text;
  const ProgramRun run = RunSextant("rig " + wrong + " --out " + out);
  EXPECT_EQ(run.exit_code, 3) << run.out;
  EXPECT_THAT(run.out, HasSubstr("NOT USABLE"));
  EXPECT_EQ(RunSextant("export " + out + " --to ros2").exit_code, 3);
  EXPECT_EQ(RunSextant("export " + out + " --to ros2 --force").exit_code, 0);
}

TEST(RigCommand, OneCameraOfSeveralIsCalibratedAlone) {
  const std::string out = TestPath("left.yaml");
  const ProgramRun run = RunSextant("calibrate " + SessionOfRig().string() +
                                    " --camera-name left --bootstrap 0 --out " + out);
  EXPECT_THAT(test::ReadText(out), HasSubstr("cam_from_lidar")) << run.err;
}

TEST(RigCommand, ReadsTheTransformsOfTheOriginalPackage) {
  SEXTANT_REAL_DATA(path, "dhall/rts.txt");
  const std::string out = TestPath("rig.json");
  const ProgramRun run = RunSextant("rig " + path.string() + " --out " + out);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("camera_1_from_camera_2"));
  const json rig = json::parse(test::ReadText(out));
  const json& pair = rig["pairs"][2];
  EXPECT_EQ(pair["a"], "camera_1");
  // x of -0.14 and 0.257 m.
  EXPECT_NEAR(pair["a_from_b"]["translation_m"][0].get<double>(), -0.397, 1e-12);
}

}  // namespace
}  // namespace sextant
