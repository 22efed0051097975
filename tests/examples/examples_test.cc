// SPDX-License-Identifier: Apache-2.0
// The programs of examples/ run, and docs/library.md shows them as they are.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "io/images/image_codec.h"
#include "io/results/calibration_result.h"
#include "simulator/scene/scene_file.h"
#include "simulator/session/session.h"
#include "support/run_program.h"
#include "support/source_tree.h"

namespace sextant::test {
namespace {

using testing::HasSubstr;

Expected<std::string> EncodePng(const cv::Mat& image) { return EncodeImage(".png", image); }

std::filesystem::path SimulatedSession() {
  const std::string text = ReadText(SourceRoot() / "tests/examples/swinging_board.yaml");
  const Expected<Scene> scene = ParseScene(text, "example.yaml");
  EXPECT_TRUE(scene) << scene.error().message;
  const std::filesystem::path folder = TestFolder() / "session";
  const Expected<SessionReport> report = SimulateSession(
      *scene, text, {.folder = folder, .scans = 4, .interval_s = 60.0, .encode_image = EncodePng});
  EXPECT_TRUE(report) << report.error().message;
  return folder;
}

TEST(Examples, PairsGiveAPoseWithItsUncertainty) {
  const ProgramRun run = RunProgram(SEXTANT_EXAMPLE_SOLVE, "");
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("cam_from_lidar"));
  EXPECT_THAT(run.out, HasSubstr("1 sigma along x y z"));
}

TEST(Examples, ASessionIsCalibratedAndWritten) {
  const std::filesystem::path session = SimulatedSession();
  const std::filesystem::path written = TestFolder() / "result.yaml";
  const ProgramRun run =
      RunProgram(SEXTANT_EXAMPLE_CALIBRATE, session.string() + " " + written.string());
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("view 003, board 0: kept"));
  EXPECT_THAT(run.out, HasSubstr("It rests on 4 boards in 4 of 4 views"));
  EXPECT_THAT(run.err, HasSubstr("views: 4 of 4"));
  const Expected<CalibrationResult> result = ReadCalibrationResult(written);
  ASSERT_TRUE(result) << result.error().message;
  // The camera stands 5 cm before, 10 cm left of and 8 cm below the LiDAR.
  const Eigen::Vector3d cam_in_lidar = result->cam_from_lidar.Inverse().translation;
  EXPECT_LT((cam_in_lidar - Eigen::Vector3d(0.05, 0.1, -0.08)).norm(), 0.05);

  const ProgramRun nowhere = RunProgram(SEXTANT_EXAMPLE_CALIBRATE, "/nowhere/session.yaml");
  EXPECT_EQ(nowhere.exit_code, 1);
  EXPECT_THAT(nowhere.err, HasSubstr("/nowhere/session.yaml"));
}

TEST(Examples, AnOwnSolverIsRobustWithinACombinator) {
  const ProgramRun run = RunProgram(SEXTANT_EXAMPLE_OWN_SOLVER, "");
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("ransac(my_solver)    0.1000   0.2000   0.3000 m"));
  EXPECT_THAT(run.out, HasSubstr("gnc(my_solver)       0.1000   0.2000   0.3000 m"));
}

std::string TextOf(const SourceFile& file, std::size_t first_line) {
  std::string text;
  for (std::size_t i = first_line; i < file.lines.size(); ++i) text += file.lines[i] + "\n";
  return text;
}

TEST(Examples, ThePageShowsThemAsTheyAre) {
  const std::string page = ReadText(SourceRoot() / "docs/library.md");
  int examples = 0;
  for (const SourceFile& file : ReadSourceTree()) {
    if (file.folder != "examples" || !file.path.ends_with(".cc")) continue;
    ++examples;
    EXPECT_LT(file.lines.size(), 60U) << file.path;
    // All but the licence line.
    const std::string block = "```cpp\n" + TextOf(file, 1) + "```\n";
    EXPECT_NE(page.find(block), std::string::npos) << file.path << ": copy it into docs/library.md";
  }
  EXPECT_EQ(examples, 3);
}

}  // namespace
}  // namespace sextant::test
