// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <string>

#include "io/export/export_rig.h"
#include "io/export/export_transform.h"
#include "io/problems/problem_yaml.h"
#include "io/problems/rig_yaml.h"
#include "io/results/rig_result.h"
#include "support/bad_text.h"

namespace sextant {
namespace {

using test::BadText;
using testing::HasSubstr;

constexpr const char* kRigText = R"(sextant_rig: 1
root: top
sensors:
  - name: left
    camera: {model: pinhole, fx_px: 700, fy_px: 700, cx_px: 640, cy_px: 360}
  - name: top
  - name: rear
boards:
  - {id: 3, top_right_m: 0.6, right_bottom_m: 0.8}
moments:
  - name: one
    observations:
      - {sensor: left, board: 3, pixels: [500, 200, 640, 200, 640, 400, 500, 400], sigma_px: 0.2}
      - sensor: top
        board: 3
        points_m: [[3, 0.3, 0.4], [3, -0.3, 0.4], [3, -0.3, -0.4], [3, 0.3, -0.4]]
      - sensor: rear
        board: 3
        plane: {normal: [2, 0, 0], distance_m: 3, sigma_deg: 0.3}
        lines:
          - {side: 2, point_m: [3, 0, -0.4], direction: [0, 3, 0]}
)";

std::string RigWith(const std::string& from, const std::string& to) {
  std::string text = kRigText;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(RigFile, HasWhatEachSensorMeasured) {
  const Expected<RigFile> rig = ParseRigFile(kRigText, "rig.yaml");
  ASSERT_TRUE(rig) << rig.error().message;
  EXPECT_EQ(rig->root, 1U);
  ASSERT_EQ(rig->problem.placements.size(), 1U);
  const RigPlacement& placement = rig->problem.placements[0];
  ASSERT_EQ(placement.seen.size(), 3U);
  const RigObservation& left = placement.seen[0];
  ASSERT_EQ(left.raw.printed.size(), 1U);
  EXPECT_EQ(left.raw.printed[0].in_board_m[1], Eigen::Vector2d(0.3, -0.4));  // The outer corners.
  EXPECT_DOUBLE_EQ(left.raw.printed[0].covariance_px2(3, 3), 0.2 * 0.2);
  EXPECT_EQ(placement.seen[1].points[2].in_sensor_m, Eigen::Vector3d(3, -0.3, -0.4));
  EXPECT_EQ(placement.seen[2].plane->normal, Eigen::Vector3d::UnitX());
  EXPECT_EQ(placement.seen[2].lines[0].direction, Eigen::Vector3d::UnitY());
}

TEST(RigFile, RoundTripsToTheSameText) {
  const Expected<RigFile> rig = ParseRigFile(kRigText, "rig.yaml");
  ASSERT_TRUE(rig) << rig.error().message;
  const std::string text = FormatRigFile(*rig);
  const Expected<RigFile> again = ParseRigFile(text, "rig.yaml");
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(FormatRigFile(*again), text);
}

TEST(RigFile, RefusesWhatIsWrongAndNamesIt) {
  const BadText cases[] = {
      {"unknown sensor", RigWith("sensor: rear", "sensor: back"), ErrorCode::kParse,
       "expected the name of a sensor (left, top, rear), got 'back'"},
      {"unknown board", RigWith("board: 3, pixels", "board: 4, pixels"), ErrorCode::kParse,
       "expected the id of one of the boards, got 4"},
      {"too few pixels", RigWith("500, 200, 640, 200, ", "640, 200, "), ErrorCode::kParse,
       "expected 4 points"},
      {"pixels of a LiDAR", RigWith("{sensor: left", "{sensor: rear"), ErrorCode::kInvalidInput,
       "rear has pixels, and its sensor has no intrinsics"},
      {"twice", RigWith("sensor: rear\n", "sensor: top\n"), ErrorCode::kInvalidInput,
       "has board 3 of sensor 'top' twice"},
      {"no direction", RigWith("[0, 3, 0]", "[0, 0, 0]"), ErrorCode::kParse, "not zeros"},
      {"unknown key", RigWith("sigma_px", "sigma_pixels"), ErrorCode::kParse, "sigma_px"},
      {"unknown root", RigWith("root: top", "root: roof"), ErrorCode::kParse, "'roof'"}};
  for (const BadText& bad : cases) test::ExpectRefused(ParseRigFile(bad.text, "rig.yaml"), bad);
}

TEST(RigFile, IsRecognisedByTheReaderOfProblems) {
  const Expected<ProblemFile> problem = ParseProblemYaml(kRigText, "rig.yaml");
  ASSERT_FALSE(problem);
  EXPECT_THAT(problem.error().message, HasSubstr("run 'sextant rig' with it"));
  EXPECT_TRUE(IsRigFile("# a comment\nsextant_rig: 1\n"));
  EXPECT_FALSE(IsRigFile("sextant_problem: 1\n"));
}

RigResult ThreeSensors() {
  RigResult result{.version = "1", .root = "top"};
  Camera camera{.fx_px = 700, .fy_px = 700, .cx_px = 640, .cy_px = 360};
  result.sensors.push_back({.name = "top", .root_from_sensor = Rigid3d{}});
  result.sensors.push_back(
      {.name = "left",
       .camera = camera,
       .root_from_sensor = Rigid3d{Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), {0.1, 0.2, 0.3}}});
  result.sensors.push_back({.name = "lost"});
  return result;
}

TEST(RigResult, IsReadBack) {
  const std::string text = FormatRigResult(ThreeSensors());
  EXPECT_TRUE(IsRigResult(text));
  const Expected<RigResult> read = ParseRigResult(text, "rig.json");
  ASSERT_TRUE(read) << read.error().message;
  const Expected<Rigid3d> pose = read->Between("left", "top");
  ASSERT_TRUE(pose);
  EXPECT_LT(DistanceBetween(*pose, *ThreeSensors().Between("left", "top")).translation_m, 1e-12);
  EXPECT_THAT(read->Between("lost", "top").error().message, HasSubstr("not connected"));
  EXPECT_THAT(read->Between("right", "top").error().message, HasSubstr("top, left, lost"));
}

TEST(RigResult, RoundTripsToTheSameText) {
  RigResult rig = ThreeSensors();
  rig.sensors[1].covariance = 1e-6 * Matrix6d::Identity();
  rig.sensors[1].views = 7;
  rig.sensors[1].used = 6;
  rig.pairs = {{.a = "top", .b = "left", .covariance = 2e-6 * Matrix6d::Identity(), .views = 5}};
  rig.pairs[0].alone_a_from_b = Rigid3d{};
  rig.pairs[0].alone_sigmas = 1.25;
  rig.views = {{.moment = "000",
                .board = 3,
                .seen = {{.sensor = "top", .used = true, .rms = 0.9}, {.sensor = "left"}}}};
  rig.numbers = {{.sensor = "top", .name = "range_offset_m", .value = 0.01, .sigma = 0.002}};
  rig.unconnected = {"lost sees no board with another sensor"};
  rig.warnings = {"a warning"};
  const std::string text = FormatRigResult(rig);
  const Expected<RigResult> read = ParseRigResult(text, "rig.json");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(FormatRigResult(*read), text);
}

TEST(RigResult, SaysWhyItIsNotUsable) {
  RigResult rig = ThreeSensors();
  rig.refutations = {"the print is \"small\""};
  const Expected<RigResult> read = ParseRigResult(FormatRigResult(rig), "rig.json");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->refutations, rig.refutations);
}

TEST(RigResult, HasItsRootAmongItsSensors) {
  RigResult rig = ThreeSensors();
  rig.root = "nobody";
  const Expected<RigResult> read = ParseRigResult(FormatRigResult(rig), "rig.json");
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().message, HasSubstr("root: expected the name of one of the sensors"));
}

TEST(ExportRig, EveryFormatHasEverySensor) {
  const RigResult rig = ThreeSensors();
  for (const char* format : {"ros1", "ros2", "ros2_yaml", "urdf", "kitti"}) {
    const Expected<std::string> text = ExportRig(format, rig);
    ASSERT_TRUE(text) << format;
    EXPECT_THAT(*text, HasSubstr("left")) << format;
    EXPECT_THAT(*text, HasSubstr("top")) << format;
  }
  EXPECT_THAT(ExportRig("png", rig).error().message, HasSubstr("--sensors"));
}

TEST(ExportRig, APairIsInEveryFormat) {
  const Expected<CalibrationResult> pair = ResultOfPair(ThreeSensors(), "left", "top");
  ASSERT_TRUE(pair);
  ExportOptions frames{.camera_frame = pair->camera_frame, .lidar_frame = pair->lidar_frame};
  for (const ExportFormat& format : ExportFormats()) {
    EXPECT_TRUE(ExportTransform(format.name, *pair, frames)) << format.name;
  }
}

}  // namespace
}  // namespace sextant
