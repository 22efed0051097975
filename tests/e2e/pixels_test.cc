// SPDX-License-Identifier: Apache-2.0
// solve and compare on 2D-3D pairs: the contents of the answer, and bad input of every kind.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>

#include "e2e/run_sextant.h"
#include "support/run_program.h"

namespace sextant {
namespace {

using nlohmann::json;
using test::ProgramRun;
using test::RunSextant;
using test::TestFolder;
using test::WriteText;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string InFolder(const char* name, const std::string& text) {
  const auto path = TestFolder() / name;
  WriteText(path, text);
  return path.string();
}

const std::string kCamera =
    "image_width: 1280\nimage_height: 720\nK: [700, 0, 639.5, 0, 700, 359.5, 0, 0, 1]\n";

using Point = std::array<double, 3>;

const std::vector<Point> kPoints = {{-0.9, -0.5, 3.1}, {0.8, -0.6, 2.4}, {0.7, 0.9, 3.8},
                                    {-0.6, 0.7, 2.6},  {0.1, 0.2, 3.4},  {-0.3, -0.8, 2.2},
                                    {0.5, 0.1, 2.9},   {-0.8, 0.2, 3.6}};

// The camera and the LiDAR are in the same place; `sign` -1 puts the point behind the camera.
std::string Row(const Point& p, double sign = 1.0) {
  const double u = 639.5 + 700.0 * p[0] / p[2];
  const double v = 359.5 + 700.0 * p[1] / p[2];
  std::string row;
  for (const double x : {u, v, sign * p[0], sign * p[1], sign * p[2]}) {
    row += std::to_string(x) + ",";
  }
  return row + "1\n";
}

const std::string kHeader = "u,v,x,y,z,sigma_px\n";

std::string Csv(const std::vector<Point>& points, double sign = 1.0) {
  std::string text = kHeader;
  for (const Point& p : points) text += Row(p, sign);
  return text;
}

TEST(Pixels, CompareTakesACsvAndACamera) {
  const std::string pairs = InFolder("pairs.csv", Csv(kPoints));
  const std::string camera = InFolder("camera.yaml", kCamera);
  const ProgramRun run = RunSextant("compare " + pairs + " --camera " + camera + " --json -");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  int answers = 0;
  const json document = json::parse(run.out);
  for (const json& result : document.at("results")) {
    if (!result.at("ok") || result.at("solver") == "opencv.ippe") continue;
    ++answers;
    EXPECT_LT(result.at("rmse_px").get<double>(), 0.01) << result.at("solver");
    EXPECT_EQ(result.at("per_pair_px").size(), kPoints.size());
    EXPECT_TRUE(result.at("rmse_m").is_null());
  }
  EXPECT_GE(answers, 8);
}

TEST(Pixels, BothErrorsStandInTheAnswerWhereBothKindsAreGiven) {
  const std::string session = (TestFolder() / "session.yaml").string();
  ASSERT_EQ(RunSextant("simulate pairs --outliers 0 --out " + session).exit_code, 0);
  for (const char* solver : {"'refine(epnp)'", "kabsch", "'refine(kabsch,on=both)'"}) {
    const std::string command = "solve " + session + " --solver " + solver;
    const ProgramRun text = RunSextant(command);
    ASSERT_EQ(text.exit_code, 0) << text.err;
    EXPECT_THAT(text.out, AllOf(HasSubstr("m over 8 pairs"), HasSubstr("px over 8 pairs"),
                                HasSubstr("residual [mm]"), HasSubstr("residual [px]")));
    const ProgramRun run = RunSextant(command + " --json -");
    const json document = json::parse(run.out);
    const json& result = document.at("results").at(0);
    EXPECT_GT(result.at("rmse_m").get<double>(), 0.0);
    EXPECT_GT(result.at("rmse_px").get<double>(), 0.0);
    EXPECT_EQ(result.at("per_pair_m").size(), 8U);
    EXPECT_EQ(result.at("per_pair_px").size(), 8U);
    EXPECT_EQ(result.at("inliers").size(), 8U);
  }
}

TEST(Pixels, EstimatedIntrinsicsAreInTheAnswer) {
  const std::string pairs = InFolder("pairs.csv", Csv(kPoints));
  std::string wrong = kCamera;
  for (std::size_t at = wrong.find("700"); at != std::string::npos; at = wrong.find("700")) {
    wrong.replace(at, 3, "770");
  }
  const std::string command = "solve " + pairs + " --camera " + InFolder("wrong.yaml", wrong) +
                              " --solver 'refine(epnp, intrinsics=focal)'";
  EXPECT_THAT(RunSextant(command).out, HasSubstr("camera, also estimated"));
  const ProgramRun run = RunSextant(command + " --json -");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json document = json::parse(run.out);
  const json& camera = document.at("results").at(0).at("camera");
  EXPECT_NEAR(camera.at("fx_px").get<double>(), 700.0, 0.01);
  EXPECT_EQ(camera.at("estimated").at(1).at("name"), "fy_px");
  EXPECT_GT(camera.at("estimated").at(1).at("sigma").get<double>(), 0.1);
}

TEST(Pixels, TheCameraOfAProblemFileCanBeUsedForOthers) {
  const std::string session = (TestFolder() / "session.yaml").string();
  ASSERT_EQ(RunSextant("simulate pairs --out " + session).exit_code, 0);
  const std::string pairs = InFolder("pairs.csv", Csv(kPoints));
  EXPECT_EQ(RunSextant("solve " + pairs + " --solver epnp --camera " + session).exit_code, 0);
}

struct BadPairs {
  const char* name;
  std::string text;
  const char* message;
};

void PrintTo(const BadPairs& bad, std::ostream* out) { *out << bad.name; }

class BadPixels : public testing::TestWithParam<BadPairs> {};

// No pose, exit code 1 or 2, and one line that names the file and what is wrong with it.
TEST_P(BadPixels, EndInOneLineWithTheReason) {
  const std::string pairs = InFolder("bad.csv", GetParam().text);
  const std::string camera = InFolder("camera.yaml", kCamera);
  for (const char* solver : {"epnp", "'refine(ransac(epnp))'"}) {
    const ProgramRun run =
        RunSextant("solve " + pairs + " --camera " + camera + " --solver " + solver);
    EXPECT_TRUE(run.exit_code == 1 || run.exit_code == 2) << solver << run.exit_code << run.out;
    EXPECT_THAT(run.out, Not(HasSubstr("cam_from_lidar"))) << solver;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr(pairs)) << solver;
    if (std::string(solver) == "epnp") {
      EXPECT_THAT(run.err, HasSubstr(GetParam().message));
    }
  }
}

std::vector<Point> OnALine() {
  std::vector<Point> points;
  for (int i = 0; i < 8; ++i) points.push_back({0.1 * i, 0.2 * i, 2.0 + 0.3 * i});
  return points;
}

std::vector<Point> Times(double factor) {
  std::vector<Point> points = kPoints;
  for (Point& p : points) {
    for (double& x : p) x *= factor;
  }
  return points;
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, BadPixels,
    testing::Values(BadPairs{"three", Csv({kPoints[0], kPoints[1], kPoints[2]}),
                             "at least 4 2D-3D pairs, got 3"},
                    BadPairs{"line", Csv(OnALine()), "on one line"},
                    BadPairs{"far", Csv(Times(1e12)), "are they in metres?"},
                    BadPairs{"infinite", kHeader + "inf,1,1,1,1,1\n", "bad.csv:2: field 1 (u)"},
                    BadPairs{"behind", Csv(kPoints, -1.0), "behind the camera"},
                    BadPairs{"one_pair_eight_times", Csv(std::vector<Point>(8, kPoints[0])),
                             "only 1 of 8 points differ"},
                    BadPairs{"negative_sigma", kHeader + "1,1,1,1,1,-1\n",
                             "bad.csv:2: expected sigma_px >= 0, got -1"},
                    BadPairs{"missing_field", kHeader + "1,1,1,1\n", "bad.csv:2:"}),
    [](const auto& kind) { return std::string(kind.param.name); });

// Pixels that are unrelated to the points.
TEST(Pixels, OnlyOutliersAreNoConsensus) {
  std::string text = kHeader;
  for (int i = 0; i < 40; ++i) {
    const Point& p = kPoints[static_cast<std::size_t>(i) % kPoints.size()];
    text += std::to_string((i * 397) % 1280) + "," + std::to_string((i * 251) % 720) + ",";
    text += std::to_string(p[0] + 0.01 * i) + "," + std::to_string(p[1] - 0.007 * i) + "," +
            std::to_string(p[2]) + ",1\n";
  }
  const std::string pairs = InFolder("outliers.csv", text);
  const std::string camera = InFolder("camera.yaml", kCamera);
  for (const char* solver :
       {"ransac(p3p)", "refine(ransac(epnp))", "gnc(epnp)", "drop_worst(epnp)"}) {
    const ProgramRun run = RunSextant("solve " + pairs + " --camera " + camera + " --solver '" +
                                      solver + "' --json -");
    EXPECT_EQ(run.exit_code, 1) << solver;
    const json document = json::parse(run.out);
    const json& result = document.at("results").at(0);
    EXPECT_EQ(result.at("error_code"), "no_consensus") << solver << result.at("error");
    EXPECT_TRUE(result.at("cam_from_lidar").is_null());
  }
}

// Copies count once, so that they are no consensus: too few pairs are left.
TEST(Pixels, AMinimalSampleGivenManyTimesIsNoConsensus) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < 20; ++i) points.push_back(kPoints[i % 4]);
  const ProgramRun run =
      RunSextant("solve " + InFolder("twice.csv", Csv(points)) + " --camera " +
                 InFolder("camera.yaml", kCamera) + " --solver 'ransac(epnp)' --json -");
  EXPECT_EQ(run.exit_code, 1);
  const json document = json::parse(run.out);
  EXPECT_EQ(document.at("results").at(0).at("error_code"), "too_few_pairs");
  EXPECT_THAT(run.err, HasSubstr("only 4 of 20 points differ"));
}

TEST(Pixels, BadCamerasAreNamed) {
  const std::string pairs = InFolder("pairs.csv", Csv(kPoints));
  const auto changed = [](const std::string& from, const std::string& to) {
    std::string text = kCamera;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  const std::pair<std::string, const char*> cameras[] = {
      {changed("[700", "[0"), "focal lengths 0 and 700 px, expected both > 0"},
      {changed("[700", "[-700"), "focal lengths -700 and 700 px"},
      {changed("0, 0, 1]", "0, 0]"), "camera matrix: expected 9 numbers, got 8"},
      {kCamera + "D: [-20, 0, 0, 0, 0]\n", "distortion folds the image"},
      {kCamera + "D: [nan, 0, 0, 0, 0]\n", "distortion coefficients"},
      {Csv(kPoints), "expected a camera"},
      {std::string("\x89PNG\r\n\x1a\n\0\0", 10), "zero byte"},
      {"", "is empty"},
  };
  for (const auto& [text, message] : cameras) {
    const std::string camera = InFolder("bad.yaml", text);
    for (const char* command : {"solve ", "compare "}) {
      const ProgramRun run = RunSextant(command + pairs + " --camera " + camera);
      EXPECT_EQ(run.exit_code, 2) << message;
      EXPECT_THAT(run.err, AllOf(HasSubstr(camera), HasSubstr(message)));
      EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    }
  }
  EXPECT_EQ(RunSextant("solve " + pairs + " --camera /nowhere.yaml").exit_code, 2);
  EXPECT_EQ(RunSextant("solve " + pairs + " --camera " + TestFolder().string()).exit_code, 2);
}

TEST(Pixels, AMissingCameraIsReported) {
  const std::string pairs = InFolder("pairs.csv", Csv(kPoints));
  for (const char* command : {"solve --solver epnp ", "compare "}) {
    const ProgramRun run = RunSextant(command + pairs);
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_THAT(run.err, AllOf(HasSubstr(pairs), HasSubstr("--camera")));
  }
}

// Pixels of another camera: whatever few pairs some solver fits, compare refuses what no answer to
// most of them explains.
TEST(Pixels, CompareRefusesWhatNoPoseExplains) {
  std::string text = "u,v,x,y,z\n";
  for (const Point& p : kPoints) {
    for (const Point& q : {p, Point{-p[1], 0.9 * p[0] + 0.1, p[2] + 0.7}}) {
      const double u = 639.5 + 1400.0 * q[0] / q[2];
      const double v = 359.5 + 350.0 * q[1] / q[2];
      text += std::to_string(u) + "," + std::to_string(v);
      for (const double x : q) text += "," + std::to_string(x);
      text += "\n";
    }
  }
  const std::string pairs = InFolder("other_camera.csv", text);
  const std::string camera = InFolder("camera.yaml", kCamera);
  const ProgramRun run =
      RunSextant("compare " + pairs + " --camera " + camera + " --solvers epnp,opencv.magsac");
  EXPECT_EQ(run.exit_code, 3) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("NOT USABLE"));
}

// Four corners of a small square far away have two poses.
TEST(Pixels, CompareShowsTheSecondPoseOfTheBestAnswer) {
  std::string text = kHeader;
  for (const Point& corner : std::vector<Point>{
           {-0.1, -0.1, 4.0}, {0.1, -0.1, 4.05}, {0.1, 0.1, 4.05}, {-0.1, 0.1, 4.0}}) {
    text += Row(corner);
  }
  const std::string pairs = InFolder("square.csv", text);
  const std::string camera = InFolder("camera.yaml", kCamera);
  const ProgramRun run =
      RunSextant("compare " + pairs + " --camera " + camera + " --solvers 'refine(sqpnp)'");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("also explains the data"));
}

TEST(Pixels, MessagesOfOpenCvAreOneLine) {
  const std::vector<Point> five(kPoints.begin(), kPoints.begin() + 5);
  const std::string pairs = InFolder("five.csv", Csv(five));
  const std::string camera = InFolder("camera.yaml", kCamera);
  const ProgramRun run =
      RunSextant("solve " + pairs + " --camera " + camera + " --solver opencv.iterative");
  EXPECT_THAT(run.err + run.out, Not(HasSubstr("\\x0a")));
}

}  // namespace
}  // namespace sextant
