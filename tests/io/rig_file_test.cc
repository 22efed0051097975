// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <string>

#include "io/export/export_rig.h"
#include "io/export/export_transform.h"
#include "io/problems/feature_table.h"
#include "io/problems/problem_yaml.h"
#include "io/problems/rig_yaml.h"
#include "io/results/rig_result.h"
#include "support/bad_text.h"
#include "support/run_program.h"

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

// Edges on the rims of round holes mean nothing on a board without them.
TEST(RigFile, KeepsTheRoundHolesOfABoard) {
  const Expected<RigFile> rig =
      ParseRigFile(RigWith("right_bottom_m: 0.8}",
                           "right_bottom_m: 0.8, hole: {width_m: 0.1, height_m: 0.1}, round_holes: "
                           "[{radius_m: 0.05, center_in_board_m: [0.2, 0.25]}, {radius_m: 0.06, "
                           "center_in_board_m: [-0.2, 0.25]}]}"),
                   "rig.yaml");
  ASSERT_TRUE(rig) << rig.error().message;
  const Expected<RigFile> again = ParseRigFile(FormatRigFile(*rig), "rig.yaml");
  ASSERT_TRUE(again) << again.error().message;
  const Board& board = again->problem.boards.at(0);
  ASSERT_EQ(board.round_holes.size(), 2U);
  EXPECT_EQ(board.round_holes[1].radius_m, 0.06);
  EXPECT_EQ(board.round_holes[1].center_in_board_m, Eigen::Vector2d(-0.2, 0.25));
  EXPECT_EQ(board.hole->width_m, 0.1);
}

TEST(RigFile, KeepsTheSigmaOfEachPoint) {
  const std::string points = "points_m: [[3, 0.3, 0.4]";
  const Expected<RigFile> rig = ParseRigFile(
      RigWith(points, "sigma_m: [0.01, 0.02, 0.03, 0.04]\n        " + points), "rig.yaml");
  ASSERT_TRUE(rig) << rig.error().message;
  const Expected<RigFile> again = ParseRigFile(FormatRigFile(*rig), "rig.yaml");
  ASSERT_TRUE(again) << again.error().message;
  const auto& seen = again->problem.placements.at(0).seen.at(1).points;
  ASSERT_EQ(seen.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(seen[i].sigma_m, 0.01 * static_cast<double>(i + 1), 1e-15);
  const Expected<RigFile> few =
      ParseRigFile(RigWith(points, "sigma_m: [0.01, 0.02]\n        " + points), "rig.yaml");
  ASSERT_FALSE(few);
  EXPECT_THAT(few.error().message, HasSubstr("expected one number, or 4"));
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
      {"sigma without pixels", RigWith("sensor: top\n", "sensor: top\n        sigma_px: 0.2\n"),
       ErrorCode::kParse, "describes pixels, which the observation does not have"},
      {"points without a measurement",
       RigWith("sensor: rear\n", "sensor: rear\n        in_board_m: [0, 0]\n"), ErrorCode::kParse,
       "describes pixels or points_m"},
      {"unknown root", RigWith("root: top", "root: roof"), ErrorCode::kParse, "'roof'"}};
  for (const BadText& bad : cases) test::ExpectRefused(ParseRigFile(bad.text, "rig.yaml"), bad);
}

TEST(FeatureTable, HasTheRowsOfEachKind) {
  // Names of other programs, semicolons and decimal commas; an empty value is none.
  const auto rows = ParseFeatureTable(
      "frame;sensor;board;corner;pixel_x;pixel_y;x [m];y [m];z [m];Sigma px\n"
      "a;left;3;1;500,5;200;;;;0,2\n"
      "a;top;3;2;;;3;-0,3;0,4;\n",
      "f.csv");
  ASSERT_TRUE(rows) << rows.error().message;
  ASSERT_EQ(rows->size(), 2U);
  EXPECT_EQ((*rows)[0].moment, "a");
  EXPECT_EQ((*rows)[0].pixel, Eigen::Vector2d(500.5, 200));
  EXPECT_EQ((*rows)[0].sigma_px, 0.2);
  EXPECT_FALSE((*rows)[0].position_m);
  EXPECT_EQ((*rows)[1].position_m, Eigen::Vector3d(3, -0.3, 0.4));
  EXPECT_EQ((*rows)[1].line, 3);
  const auto planes = ParseFeatureTable("moment,sensor,a,b,c,d\n1,top,0,0,2,-6\n", "f.csv");
  ASSERT_TRUE(planes) << planes.error().message;
  EXPECT_EQ((*planes)[0].plane->normal, Eigen::Vector3d::UnitZ());
  EXPECT_EQ((*planes)[0].plane->distance_m, 3.0);  // 2 z - 6 = 0.
  const auto normals =
      ParseFeatureTable("moment,sensor,nx,ny,nz,distance\n1,top,0,0,2,3\n", "f.csv");
  ASSERT_TRUE(normals) << normals.error().message;
  EXPECT_EQ((*normals)[0].plane->normal, Eigen::Vector3d::UnitZ());
  EXPECT_EQ((*normals)[0].plane->distance_m, 3.0) << "that of the unit normal, as in a rig file";
  const auto sides =
      ParseFeatureTable("time_s,sensor,side,x,y,z,x2,y2,z2\n0.5,top,2,1,0,0,1,0,2\n", "f.csv");
  ASSERT_TRUE(sides) << sides.error().message;
  EXPECT_EQ((*sides)[0].side->direction, Eigen::Vector3d::UnitZ());
  EXPECT_FALSE((*sides)[0].position_m);
}

TEST(FeatureTable, RefusesWhatIsWrongAndNamesIt) {
  const BadText cases[] = {
      {"unknown column", "moment,sensr,corner,u,v\n", ErrorCode::kParse, "did you mean 'sensor'"},
      {"no moment", "sensor,corner,u,v\n", ErrorCode::kParse, "moment is missing"},
      {"half a point", "moment,sensor,corner,x,y\n", ErrorCode::kParse,
       "expected the column z as well: x, y, z belong together"},
      {"no corner", "moment,sensor,u,v\n1,left,3,4\n", ErrorCode::kParse,
       "expected the number of the corner"},
      {"nothing measured", "moment,sensor,corner,u,v\n1,left,3,,\n", ErrorCode::kParse,
       "f.csv:2: the row has neither"},
      {"a side without direction", "moment,sensor,side,x,y,z\n1,top,0,1,2,3\n", ErrorCode::kParse,
       "a side is a line"},
      {"nanoseconds", "time,sensor,corner,u,v\n1690000000000000000,left,0,3,4\n", ErrorCode::kParse,
       "nanoseconds"},
      {"not a number", "moment,sensor,corner,u,v\n1,left,0,3,four\n", ErrorCode::kParse,
       "field 5 (v)"}};
  for (const BadText& bad : cases) test::ExpectRefused(ParseFeatureTable(bad.text, "f.csv"), bad);
}

constexpr const char* kTableRig = R"(sextant_rig: 1
sensors:
  - name: left
    camera: {model: pinhole, fx_px: 700, fy_px: 700, cx_px: 640, cy_px: 360}
  - name: top
boards:
  - {id: 3, grid: {columns: 3, rows: 2, step_m: 0.1}}
tables: [pixels.csv, others.csv]
)";

Expected<RigFile> RigOfTables(const std::string& pixels, const std::string& others,
                              const std::string& rig = kTableRig) {
  test::WriteText(test::TestPath("rig.yaml"), rig);
  test::WriteText(test::TestPath("pixels.csv"), pixels);
  test::WriteText(test::TestPath("others.csv"), others);
  return ReadRigFile(test::TestPath("rig.yaml"));
}

TEST(FeatureTable, RowsOfOneMomentSensorAndBoardAreOneObservation) {
  const auto rig = RigOfTables(
      "moment,sensor,corner,u,v\nb,left,0,500,200\nb,left,5,600,300\na,left,0,400,200\n",
      "moment,sensor,corner,x,y,z,nx,ny,nz,distance\nb,top,4,3,0,0,,,,\nb,top,,,,,1,0,0,3\n");
  ASSERT_TRUE(rig) << rig.error().message;
  ASSERT_EQ(rig->problem.placements.size(), 2U);
  const RigPlacement& first = rig->problem.placements[0];
  EXPECT_EQ(first.name, "b");
  ASSERT_EQ(first.seen.size(), 2U);
  const BoardPoints& printed = first.seen[0].raw.printed.at(0);
  // Row by row: the last point of 3 x 2 is at the lower right.
  EXPECT_LT((printed.in_board_m[1] - Eigen::Vector2d(0.1, 0.05)).norm(), 1e-15);
  EXPECT_EQ(printed.pixels[1], Eigen::Vector2d(600, 300));
  EXPECT_EQ(first.seen[1].points.at(0).in_sensor_m, Eigen::Vector3d(3, 0, 0));
  EXPECT_EQ(first.seen[1].plane->distance_m, 3.0);
  const std::string text = FormatRigFile(*rig);
  const auto again = ParseRigFile(text, "rig.yaml");
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(FormatRigFile(*again), text);
}

TEST(FeatureTable, RowsWithTimesAreMomentsOfAFifthOfASecond) {
  const auto rig = RigOfTables(
      "time_s,sensor,corner,u,v\n10.1,left,0,5,2\n10,left,0,5,2\n"
      "10.31,left,0,5,2\n",
      "time_s,sensor,nx,ny,nz,distance\n10.15,top,1,0,0,3\n");
  ASSERT_TRUE(rig) << rig.error().message;
  ASSERT_EQ(rig->problem.placements.size(), 2U);
  ASSERT_EQ(rig->problem.placements[0].seen.size(), 3U);
  EXPECT_EQ(rig->problem.placements[0].seen[2].time_s, 10.15);
  EXPECT_EQ(rig->problem.placements[1].seen.size(), 1U);
  const std::string text = FormatRigFile(*rig);
  const auto again = ParseRigFile(text, "rig.yaml");
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(FormatRigFile(*again), text);
}

TEST(FeatureTable, NamesThatTheRigDoesNotHaveAreRefused) {
  const std::string good = "moment,sensor,corner,u,v\n1,left,0,5,2\n";
  const auto refused = [&](const std::string& others, const std::string& reason) {
    const auto rig = RigOfTables(good, others);
    ASSERT_FALSE(rig) << reason;
    EXPECT_THAT(rig.error().message, HasSubstr("others.csv:2: " + reason));
  };
  refused("moment,sensor,corner,u,v\n1,right,0,5,2\n",
          "no sensor 'right' in the rig file; there are: left, top");
  refused("moment,sensor,board,corner,u,v\n1,left,4,0,5,2\n", "the rig file has no board 4");
  refused("moment,sensor,corner,u,v\n1,left,6,5,2\n", "corner 6: board 3 has the points 0 to 5");
  refused("moment,sensor,corner,u,v\n1,left,0,5,2\n", "the pixel of this corner is a second");
  refused("moment,sensor,side,x,y,z,dx,dy,dz\n1,top,0,3,0,0,0,1,0\n",
          "the line of a side needs the size of board 3");
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

// Two dashes would end the comment of a launch file.
TEST(ExportRig, RefusesANameThatNeedsAnEscape) {
  RigResult rig = ThreeSensors();
  rig.sensors.back().name = "to--p";
  const Expected<std::string> text = ExportRig("ros1", rig);
  ASSERT_FALSE(text);
  EXPECT_THAT(text.error().message, HasSubstr("the sensor's frame is named 'to--p'"));
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
