// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <sstream>

#include "e2e/run_sextant.h"
#include "eval/synthetic/simulate_views.h"
#include "io/problems/problem_yaml.h"
#include "support/pictures.h"
#include "support/real_data.h"
#include "support/run_program.h"

namespace sextant {
namespace {

using nlohmann::json;
using test::ProgramRun;
using test::ReadText;
using test::RunSextant;
using test::TestFolder;
using test::TestPath;
using test::WriteText;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// The paper's two boards seen from a known pose, as points.txt.
std::string SimulatedSession(const std::string& options = "") {
  std::string path = (TestFolder() / "session.yaml").string();
  const ProgramRun run = RunSextant("simulate pairs --out " + path + " " + options);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return path;
}

TEST(Cli, NamesTheCommandThatIsMeant) {
  const ProgramRun run = RunSextant("calibrat --image photo.png");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.err, "sextant has no command 'calibrat'; did you mean 'calibrate'?\n");
}

TEST(Cli, NamesTheNewNameOfARenamedCommand) {
  for (const auto& [old_name, new_name] :
       {std::pair("board", "print-board"), std::pair("solvers", "list solvers"),
        std::pair("detectors", "list detectors"), std::pair("extractors", "list extractors"),
        std::pair("lidars", "list lidars"), std::pair("kinds", "list kinds")}) {
    const ProgramRun run = RunSextant(old_name);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(run.err,
              std::string("'sextant ") + old_name + "' is now 'sextant " + new_name + "'\n");
  }
}

// OpenCV's image formats depend on more than a hundred shared objects; see io/images.
TEST(Cli, StartsWithoutTheImageFormats) {
#ifndef SEXTANT_LAZY_IMAGE_FORMATS
  GTEST_SKIP() << "this OpenCV's image formats are linked";
#endif
  const ProgramRun run = test::RunProgram("LD_TRACE_LOADED_OBJECTS=1 " SEXTANT_BINARY, "");
  ASSERT_THAT(run.out, HasSubstr("libopencv_core")) << run.err;
  EXPECT_THAT(run.out, Not(HasSubstr("libopencv_imgcodecs")));
}

TEST(Cli, HelpTeachesEveryCommand) {
  const ProgramRun top = RunSextant("--help");
  EXPECT_EQ(top.exit_code, 0);
  EXPECT_THAT(top.out, HasSubstr("4 an output could not be written"));
  for (const std::string command :
       {"calibrate", "capture",        "advise",      "project", "report",
        "export",    "detect",         "boards",      "mark",    "bag",
        "simulate",  "simulate pairs", "print-board", "convert", "fuse",
        "solve",     "compare",        "average",     "list",    "run",
        "merge",     "reproduce",      "rig",         "check",   "refine-scene"}) {
    if (command.find(' ') == std::string::npos) {
      EXPECT_THAT(top.out, HasSubstr("\n  " + command + " "));
    }
    const ProgramRun help = RunSextant(command + " --help");
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_THAT(help.out, HasSubstr("Example"));
    if (command != "list") {
      EXPECT_THAT(help.out, HasSubstr("--overwrite")) << command << " writes files";
    }
  }
  EXPECT_THAT(RunSextant("--version").out,
              testing::MatchesRegex(
                  "[0-9]+\\.[0-9]+\\.[0-9]+\nbuilt with .*\nlibraries .*OpenCV.*\ncompiler .*\n"));
}

TEST(Cli, WrongUseOfAFileSaysWhatWasExpected) {
  const std::string points = TestPath("points.txt");
  WriteText(points, "1\n1 2 3\n1 2 3\n");
  EXPECT_THAT(RunSextant("calibrate " + points).err, HasSubstr("run 'sextant solve' with it"));
  EXPECT_THAT(RunSextant("average " + points).err, Not(HasSubstr("from 1 to 1")));
  const ProgramRun elsewhere =
      test::RunProgram("cd " + TestFolder().string() + " && " SEXTANT_BINARY, "reproduce --quick");
  EXPECT_EQ(elsewhere.exit_code, 2);
  EXPECT_THAT(elsewhere.err, HasSubstr("run it in the project's folder"));
  const ProgramRun mark = RunSextant("mark --cloud " + points + " --render /nowhere/a.png");
  EXPECT_THAT(mark.err, HasSubstr("cannot write '/nowhere/a.png'"));
}

TEST(Cli, WrongUsageEndsInTwo) {
  EXPECT_EQ(RunSextant("").exit_code, 2);
  EXPECT_EQ(RunSextant("slove").exit_code, 2);
  EXPECT_EQ(RunSextant("solve").exit_code, 2);
  EXPECT_EQ(RunSextant("solve /nowhere/points.txt").exit_code, 2);
  const ProgramRun run = RunSextant("solve " + SimulatedSession() + " --solver kabsh");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("did you mean 'kabsch'?"));
}

TEST(Cli, NoAnswerEndsInOneAndSaysWhy) {
  const auto path = TestFolder() / "line.txt";
  WriteText(path, "4\n1 0 0\n2 0 0\n3 0 0\n4 0 0\n0 0 1\n0 0 2\n0 0 3\n0 0 4\n");
  const ProgramRun run = RunSextant("solve " + path.string());
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("on one line"));
}

TEST(Cli, SolveWritesTheJsonContract) {
  const ProgramRun run = RunSextant("solve " + SimulatedSession() + " --solver kabsch --json -");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json document = json::parse(run.out);
  EXPECT_TRUE(document.at("sextant").is_string());
  EXPECT_TRUE(document.at("input").is_object());
  const json& result = document.at("results").at(0);
  EXPECT_EQ(result.at("solver"), "kabsch");
  EXPECT_EQ(result.at("ok"), true);
  EXPECT_TRUE(result.at("error").is_null());
  const json& pose = result.at("cam_from_lidar");
  ASSERT_EQ(pose.at("matrix").size(), 4U);
  for (const json& row : pose.at("matrix")) EXPECT_EQ(row.size(), 4U);
  EXPECT_EQ(pose.at("translation_m").size(), 3U);
  EXPECT_EQ(pose.at("quaternion_wxyz").size(), 4U);
  EXPECT_EQ(pose.at("euler_zyx_deg").size(), 3U);
  EXPECT_EQ(result.at("covariance").size(), 6U);
  EXPECT_TRUE(result.at("rmse_m").is_number());
  EXPECT_EQ(result.at("per_pair_m").size(), 8U);
  EXPECT_EQ(result.at("inliers").size(), 8U);
  EXPECT_TRUE(result.at("iterations").is_number_integer());
  EXPECT_EQ(result.at("termination"), "closed_form");
  EXPECT_TRUE(result.at("wall_time_us").is_number());
}

TEST(Cli, SolvesBoardViewsOfAFileByTheJointSolver) {
  const Expected<SimulatedViews> views = SimulateViews({.views = 6, .exact = true});
  ASSERT_TRUE(views) << views.error().message;
  const auto path = TestFolder() / "views.yaml";
  WriteText(path, FormatProblemYaml({.problem = views->problem,
                                     .true_cam_from_lidar = views->true_cam_from_lidar,
                                     .comment = "six views"}));
  const ProgramRun run =
      RunSextant("solve " + path.string() + " --solver 'joint(kabsch)' --json -");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json pose = json::parse(run.out).at("results").at(0).at("cam_from_lidar");
  for (int i = 0; i < 3; ++i) {
    const double solved = pose.at("matrix").at(static_cast<std::size_t>(i)).at(3);
    EXPECT_NEAR(solved, views->true_cam_from_lidar.translation[i], 1e-5);
  }
}

TEST(Cli, JsonIsWrittenInAdditionToTheText) {
  const auto path = TestFolder() / "result.json";
  const ProgramRun run = RunSextant("solve " + SimulatedSession() + " --json " + path.string());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("cam_from_lidar"));
  EXPECT_EQ(json::parse(ReadText(path)).at("results").size(), 1U);
  EXPECT_EQ(RunSextant("solve " + SimulatedSession() + " --json /nowhere/result.json").exit_code,
            4);
}

TEST(Cli, CompareRunsEverySolverThatFits) {
  const ProgramRun run = RunSextant("compare " + SimulatedSession() + " --json -");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  std::vector<std::string> solvers;
  const json results = json::parse(run.out).at("results");
  for (const json& result : results) solvers.push_back(result.at("solver"));
  for (const char* expected : {"mean_offset", "kabsch", "eigen.umeyama", "icp", "ransac(kabsch)",
                               "gnc(kabsch)", "clique(kabsch)", "robust(kabsch)",
                               "drop_worst(kabsch)", "average(kabsch)", "refine(kabsch)"}) {
    EXPECT_THAT(solvers, testing::Contains(expected));
  }
}

TEST(Cli, RobustSolversBeatTheOutlierOfTheDemo) {
  const std::string session = SimulatedSession();
  const ProgramRun run =
      RunSextant("compare " + session + " --solvers 'kabsch,gnc(kabsch)' --json -");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json results = json::parse(run.out).at("results");
  // The best answer comes first.
  EXPECT_EQ(results.at(0).at("solver"), "gnc(kabsch)");
  EXPECT_EQ(results.at(0).at("inliers").size(), 7U);
  const ProgramRun table = RunSextant("compare " + session);
  EXPECT_THAT(table.out, HasSubstr("error [mm]"));
}

TEST(Cli, CompareIsReproducible) {
  const auto poses = [](const ProgramRun& run) {
    json document = json::parse(run.out);
    for (json& result : document.at("results")) result.erase("wall_time_us");
    return document;
  };
  const std::string session = SimulatedSession();
  EXPECT_EQ(poses(RunSextant("compare " + session + " --json -")),
            poses(RunSextant("compare " + session + " --json -")));
}

TEST(Cli, OverlayMarksThePairsOnTheImage) {
  const std::string session = SimulatedSession();
  const std::string image = (TestFolder() / "image.png").string();
  const std::string out = (TestFolder() / "overlay.png").string();
  ASSERT_TRUE(test::WritePicture(image, cv::Mat(720, 1280, CV_8UC3, cv::Scalar(90, 90, 90))));
  const ProgramRun run =
      RunSextant("solve " + session + " --solver 'gnc(kabsch)' --overlay " + image + " " + out);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const cv::Mat drawn = test::ReadPicture(out);
  ASSERT_EQ(drawn.size(), cv::Size(1280, 720));
  EXPECT_GT(cv::norm(drawn, test::ReadPicture(image), cv::NORM_L1), 1e5);

  ASSERT_TRUE(test::WritePicture(image, cv::Mat(10, 10, CV_8UC3, cv::Scalar(90, 90, 90))));
  const ProgramRun small = RunSextant("solve " + session + " --overlay " + image + " " + out);
  EXPECT_EQ(small.exit_code, 2);
  EXPECT_THAT(small.err, HasSubstr("10 x 10"));
  const ProgramRun lost = RunSextant("solve " + session + " --overlay /nowhere.png " + out);
  EXPECT_EQ(lost.exit_code, 2);
  EXPECT_THAT(lost.out, HasSubstr("cam_from_lidar")) << "the answer does not need the overlay";
}

TEST(Cli, DrawsTheResiduals) {
  const std::string session = SimulatedSession();
  const auto plot = TestFolder() / "it's a plot.svg";
  const ProgramRun run = RunSextant("compare " + session + " --plot \"" + plot.string() + "\"");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(ReadText(plot), AllOf(HasSubstr("<svg"), HasSubstr("gnc(kabsch)")));
  const ProgramRun other = RunSextant("compare " + session + " --plot plot.bmp");
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.out, HasSubstr("RMSE [mm]")) << "the answers do not need the plot";
  EXPECT_EQ(RunSextant("compare " + session + " --plot /nowhere/plot.svg").exit_code, 4);
}

TEST(Cli, ReordersCornersOnRequestAndAdvisesItOtherwise) {
  const std::string session = SimulatedSession("--outliers 0");
  const auto path = TestFolder() / "points.txt";
  ASSERT_EQ(RunSextant("convert " + session + " " + path.string()).exit_code, 0);
  // Rotate the labels of the first board's LiDAR corners.
  std::vector<std::string> lines;
  std::istringstream stream(ReadText(path));
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  std::rotate(lines.begin() + 1, lines.begin() + 2, lines.begin() + 5);
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  WriteText(path, text);

  const ProgramRun given =
      RunSextant("solve " + path.string() + " --json " + (TestFolder() / "given.json").string());
  EXPECT_THAT(given.out, HasSubstr("--reorder uses it"));
  const ProgramRun taken = RunSextant("solve " + path.string() + " --reorder --json " +
                                      (TestFolder() / "taken.json").string());
  EXPECT_EQ(taken.exit_code, 0) << taken.err;
  const auto rmse = [](const char* name) {
    return json::parse(ReadText(TestFolder() / name))
        .at("results")
        .at(0)
        .at("rmse_m")
        .get<double>();
  };
  EXPECT_LT(rmse("taken.json"), 0.03);
  EXPECT_GT(rmse("given.json"), 0.1);
}

TEST(Cli, ConvertRoundTripsThroughEveryFormat) {
  const std::string session = SimulatedSession();
  const auto folder = TestFolder();
  const std::string yaml = (folder / "again.yaml").string();
  ASSERT_EQ(RunSextant("convert " + session + " " + yaml).exit_code, 0);
  EXPECT_EQ(ReadText(session), ReadText(yaml));
  EXPECT_EQ(RunSextant("convert " + session + " " + (folder / "x.pdf").string()).exit_code, 2);
}

TEST(Cli, CatalogueDescribesEachSolver) {
  const ProgramRun list = RunSextant("list solvers");
  EXPECT_THAT(list.out, AllOf(HasSubstr("kabsch"), HasSubstr("ransac(solver)")));
  EXPECT_THAT(RunSextant("list solvers ransac").out,
              AllOf(HasSubstr("sample_size"), HasSubstr("default"), HasSubstr("reference")));
  EXPECT_EQ(RunSextant("list solvers ransax").exit_code, 2);
  const ProgramRun nothing = RunSextant("list solvers nope");
  EXPECT_THAT(nothing.err, AllOf(HasSubstr("known are "), Not(HasSubstr("did you mean"))));
  std::istringstream lines(RunSextant("list detectors --trials 0").out);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100U) << line;
}

struct BadInput {
  const char* name;
  std::string text;
};

class BadFile : public testing::TestWithParam<BadInput> {};

// No crash, no hang and no pose: exit code 1 or 2, and one line that names the file.
TEST_P(BadFile, EndsInOneLineThatNamesIt) {
  const auto path = TestFolder() / "bad.txt";
  WriteText(path, GetParam().text);
  for (const char* command : {"solve ", "compare "}) {
    const ProgramRun run = RunSextant(command + path.string());
    EXPECT_TRUE(run.exit_code == 1 || run.exit_code == 2) << run.exit_code << run.out;
    EXPECT_THAT(run.out, Not(HasSubstr("cam_from_lidar")));
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr(path.string()));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, BadFile,
    testing::Values(
        BadInput{"empty", ""}, BadInput{"truncated", "3\n1 2 3\n4 5"},
        BadInput{"words", "3\none two three\n"}, BadInput{"nan", "1\nnan 0 0\n0 0 0\n"},
        BadInput{"huge_claim", "1000000000000\n1 2 3\n"}, BadInput{"negative_claim", "-3\n1 2 3\n"},
        BadInput{"two_pairs", "2\n1 0 0\n0 1 0\n1 0 0\n0 1 0\n"},
        BadInput{"identical", "3\n1 1 1\n1 1 1\n1 1 1\n1 1 1\n1 1 1\n1 1 1\n"},
        BadInput{"decimal_comma", "3\n1,5 2 3\n4 5 6\n7 8 9\n1 2 3\n4 5 6\n7 8 9\n"},
        BadInput{"mirrored",
                 "5\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 2 3\n0 0 0\n-1 0 0\n0 1 0\n0 0 1\n-1 2 3\n"},
        BadInput{"binary", std::string("\x7f\x45\x4c\x46\x00\x01\xff\xfe\x00", 9)},
        BadInput{"deep_yaml", "a: " + std::string(100000, '[')}),
    [](const auto& kind) { return std::string(kind.param.name); });

TEST(BadFile, FoldersAndMissingFilesAreNamed) {
  const ProgramRun folder = RunSextant("solve " + TestFolder().string());
  EXPECT_EQ(folder.exit_code, 2);
  EXPECT_THAT(folder.err, HasSubstr(TestFolder().string()));
  EXPECT_EQ(RunSextant("average /nowhere").exit_code, 2);
}

TEST(RealData, PointsHeadHasThePublishedAnswer) {
  SEXTANT_REAL_DATA(points, "dhall/points_head.txt");
  const ProgramRun run =
      RunSextant("compare " + points.string() +
                 " --solvers 'kabsch,eigen.umeyama,refine(kabsch),icp(init=centroid)' --json -");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json results = json::parse(run.out).at("results");
  const std::vector<double> t = results.at(0).at("cam_from_lidar").at("translation_m");
  EXPECT_NEAR(t[0], 0.07782465, 1e-7);
  EXPECT_NEAR(t[1], -0.12717874, 1e-7);
  EXPECT_NEAR(t[2], -0.13056974, 1e-7);
  EXPECT_NEAR(results.at(0).at("rmse_m").get<double>(), 0.03914974, 1e-7);
  for (const json& result : results) {
    const std::vector<double> other = result.at("cam_from_lidar").at("translation_m");
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(other[i], t[i], 1e-9) << result.at("solver");
  }
}

TEST(RealData, AverageRecoversTheScansOfTheLog) {
  SEXTANT_REAL_DATA(log, "dhall/avg_values_head.txt");
  const ProgramRun run = RunSextant("average " + log.string() + " --json -");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json document = json::parse(run.out);
  EXPECT_EQ(document.at("iterations"), 100);
  EXPECT_EQ(document.at("distinct_scans"), 22);
  EXPECT_EQ(document.at("period"), 18);
  EXPECT_NEAR(document.at("logged_rotation_from_true_mean_deg").get<double>(), 0.28, 0.01);
}

TEST(RealData, AcfrPosesSolveWithTheirOrderTaken) {
  SEXTANT_REAL_DATA(poses, "acfr_vlp16/poses.csv");
  const ProgramRun run = RunSextant("solve " + poses.string() + " --json -");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const double rmse = json::parse(run.out).at("results").at(0).at("rmse_m");
  EXPECT_NEAR(rmse, 0.016, 0.003);
}

}  // namespace
}  // namespace sextant
