// SPDX-License-Identifier: Apache-2.0
// Poses of other programs, checked with everyday scenes.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "e2e/run_sextant.h"
#include "io/text/text_file.h"
#include "support/real_data.h"

namespace sextant {
namespace {

using test::ProgramRun;
using test::RunSextant;
using test::TestPath;
using test::WriteText;
using testing::HasSubstr;

TEST(Check, KittiByAPoseOfAnotherProgram) {
  SEXTANT_REAL_DATA(folder, "field/kitti");
  const std::string gt = (folder / "gt.json").string();
  const std::string scenes = " --camera " + gt + " --image '" + (folder / "img/*.png").string() +
                             "' --cloud '" + (folder / "pcd/*.pcd").string() + "'";
  const std::string history = TestPath("history.csv");
  const ProgramRun run = RunSextant("check " + gt + scenes + " --history " + history);
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("still valid: "));
  EXPECT_THAT(run.err, HasSubstr("read as cam_from_lidar"));
  const Expected<std::string> lines = ReadTextFile(history);
  ASSERT_TRUE(lines);
  EXPECT_THAT(*lines, HasSubstr("Z,still valid,cam_from_lidar,7,"));
  EXPECT_THAT(run.out, HasSubstr("The pose was read as cam_from_lidar."));

  // As an editor leaves it: the next line does not continue the last one.
  WriteText(history, lines->substr(0, lines->size() - 1));
  const std::string check_one = "check " + gt + " --camera " + gt + " --image " +
                                (folder / "img/000649.png").string() + " --cloud " +
                                (folder / "pcd/000649.pcd").string() + " --json -";
  const ProgramRun one = RunSextant(check_one + " --history " + history);
  EXPECT_EQ(one.exit_code, 5) << one.out << one.err;
  EXPECT_THAT(one.out, HasSubstr("\"state\": \"cannot tell\""));
  EXPECT_THAT(one.out, HasSubstr("\"pose_read_as\": \"cam_from_lidar\""));
  const Expected<std::string> more = ReadTextFile(history);
  ASSERT_TRUE(more);
  EXPECT_THAT(*more, testing::StartsWith(*lines));
  EXPECT_EQ(std::count(more->begin(), more->end(), '\n'), 3);
  // An answer that is lost is no answer.
  const ProgramRun lost = test::RunProgram("{", SEXTANT_BINARY " " + check_one + " >/dev/full; }");
  EXPECT_EQ(lost.exit_code, 4) << lost.err;
}

TEST(Check, AsksForWhatIsMissing) {
  WriteText(TestPath("flat.txt"), "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  const std::string files = " --image a.png --cloud a.pcd";
  const ProgramRun direction = RunSextant("check " + TestPath("flat.txt") + files);
  EXPECT_EQ(direction.exit_code, 2);
  EXPECT_THAT(direction.err, HasSubstr("add --pose-is cam_from_lidar or lidar_from_cam"));
  const ProgramRun camera =
      RunSextant("refine-scene " + TestPath("flat.txt") + " --pose-is cam_from_lidar" + files);
  EXPECT_EQ(camera.exit_code, 2);
  EXPECT_THAT(camera.err, HasSubstr("has no camera; expected --camera"));
}

TEST(Check, PosesWithoutAClearMeaningAreRefusedByExport) {
  const std::string path = TestPath("pose.txt");
  const auto run = [&](const std::string& text) {
    WriteText(path, text);
    return RunSextant("export " + path + " --to matrix");
  };
  const ProgramRun link =
      run("<launch><node pkg='tf2_ros' type='static_transform_publisher' name='x' "
          "args='0.1 0 -0.05 0 0 0 velodyne camera_link'/></launch>\n");
  EXPECT_EQ(link.exit_code, 2) << link.out;
  EXPECT_THAT(link.err, HasSubstr("camera_link has x forward by ROS's convention"));
  const ProgramRun millimetres = run("0 -1 0 48\n0 0 -1 -55\n1 0 0 -288\n0 0 0 1\n");
  EXPECT_EQ(millimetres.exit_code, 0) << millimetres.err;
  EXPECT_THAT(millimetres.err, HasSubstr("297 m apart; is the translation in millimetres?"));
}

}  // namespace
}  // namespace sextant
