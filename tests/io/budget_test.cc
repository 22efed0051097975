// SPDX-License-Identifier: Apache-2.0
// What the readers state in their headers of time and memory, for the worst files.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "base/random.h"
#include "io/clouds/cloud_file.h"
#include "io/poses/pose_file.h"
#include "io/problems/problem_yaml.h"
#include "io/problems/rig_yaml.h"
#include "io/results/calibration_result.h"
#include "io/text/yaml_node.h"
#include "support/calibration_result.h"
#include "support/cost/child_cost.h"

namespace sextant {
namespace {

using test::ChildCost;
using test::CostOf;
using testing::HasSubstr;

constexpr std::size_t kMiB = std::size_t{1} << 20;

std::string Filled(std::string text, std::string_view unit, std::size_t size) {
  while (text.size() < size) text += unit;
  return text;
}

void ExpectYamlBudget(const std::string& text, const char* what) {
  const ChildCost cost = CostOf([&text] {
    static_cast<void>(ParseYaml(text, "f.yaml"));
    return true;
  });
  ASSERT_TRUE(cost.ended) << what;
  EXPECT_LT(cost.peak_bytes, 20 * text.size() + 64 * kMiB) << what;
  EXPECT_LT(cost.seconds, 20.0) << what;
}

TEST(Budget, YamlTakesTwentyTimesItsSizeAnd64MiB) {
  struct Worst {
    const char* begin;
    const char* unit;
    const char* end;
  };
  constexpr Worst kWorst[] = {{"", "[", ""},
                              {"a: ", "{", ""},
                              {"a: [", "0,", "0]\n"},
                              {"a: [\n", "0,\n", "]"},
                              {"a: [", "\"\"", "]\n"},
                              {"a: [", "''", "]\n"},
                              {"a: [", "!a ", "]\n"},
                              {"a: [", "]0", "]\n"},
                              {"a: [", "[],", "]\n"},
                              {"a: [", "{},", "]\n"},
                              {"", "- ", ""},
                              {"a:\n", " - 0\n", ""},
                              {"a:\n", " - [0]\n", ""},
                              {"a:\n", " -\n", ""},
                              {"a:\n", " - {a: 0}\n", ""},
                              {"", "? ", ""},
                              {"a: {", "a:,", "}\n"},
                              {"a: ", "x", "\n"},
                              {"a: \"", "x", "\"\n"},
                              {"a: |\n", "  x\n", ""},
                              {"", "%TAG !a! b\n", ""},
                              {"a: [", "#\n", "]\n"},
                              {"", "---\n", ""},
                              {"a: &a [*a", ",*a", "]\n"}};
  for (const Worst& worst : kWorst) {
    ExpectYamlBudget(Filled(worst.begin, worst.unit, kMiB / 2) + worst.end, worst.unit);
  }
  // Long enough that the memory for each byte counts more than the 64 MiB.
  ExpectYamlBudget(Filled("a: [", "0,", 12'000'000) + "0]\n", "a list of 12 MB");
}

TEST(Budget, YamlThatIsTooDenseIsRefusedWithTheLine) {
  EXPECT_THAT(ParseYaml(Filled("a:\n", " - 0\n", 2 * kMiB), "f.yaml").error().message,
              HasSubstr("too many values for a text of this size"));
  EXPECT_THAT(ParseYaml(std::string(2 * kMiB, '['), "f.yaml").error().message,
              testing::StartsWith("f.yaml:1: not valid YAML: too many values"));
  EXPECT_THAT(ParseYaml("a: &x [1]\n", "f.yaml").error().message, HasSubstr("anchors"));
}

// 100 views of 1000 returns: 8 MB.
TEST(Budget, ProblemsOfManyPointsAreReadWhole) {
  ProblemFile file;
  file.problem.boards = {{.id = 3, .top_right_m = 0.5, .right_bottom_m = 0.5}};
  Random random(1);
  for (int view = 0; view < 100; ++view) {
    BoardView& seen = file.problem.board_views.emplace_back();
    seen.view = view;
    seen.board = 3;
    seen.range_sigma_m = 0.01;
    for (int i = 0; i < 1000; ++i) {
      const double x = random.Uniform(1.0, 9.0);
      const double y = random.Uniform(-3.0, 3.0);
      seen.face_in_lidar.emplace_back(x, y, random.Uniform(-1.0, 1.0));
    }
  }
  for (int i = 0; i < 10'000; ++i) {
    Pair3d3d& pair = file.problem.pairs_3d3d.emplace_back();
    pair.point_in_cam = {random.Uniform(), 2.0, 3.0};
    pair.point_in_lidar = {random.Uniform(), 2.0, 3.0};
    pair.sigma_m = 0.01;
    pair.id = {i, 3, i % 4};
  }
  const std::string text = FormatProblemYaml(file);
  EXPECT_GT(text.size(), 5'000'000U);
  const ChildCost cost = CostOf([&text] {
    const Expected<ProblemFile> read = ParseProblemYaml(text, "f.yaml");
    return read && read->problem.board_views.size() == 100 &&
           read->problem.board_views[99].face_in_lidar.size() == 1000 &&
           read->problem.pairs_3d3d.size() == 10'000;
  });
  EXPECT_TRUE(cost.ended) << ParseProblemYaml(text, "f.yaml").error().message;
  EXPECT_LT(cost.peak_bytes, 20 * text.size() + 64 * kMiB);
}

TEST(Budget, ResultsOfManyViewsAreReadWhole) {
  CalibrationResult result = test::FullCalibrationResult();
  ASSERT_FALSE(result.views.empty());
  const std::size_t some = result.views.size();
  for (std::size_t i = some; i < 1000; ++i) {
    ResultView view = result.views[i % some];
    view.view = static_cast<int>(i);
    view.name = fmt::format("view {}", i);
    result.views.push_back(std::move(view));
  }
  for (const std::string& text :
       {FormatCalibrationResult(result), FormatCalibrationResultJson(result)}) {
    const Expected<CalibrationResult> read = ParseCalibrationResult(text, "f");
    ASSERT_TRUE(read) << text.size() << " bytes: " << read.error().message;
    EXPECT_EQ(read->views.size(), 1000U);
  }
}

// A scan of `points` zeros: liblzf's stream is a run of 12 bytes, then repetitions of 264.
std::string CompressedZeros(std::size_t points) {
  const std::size_t bytes = 12 * points;
  EXPECT_EQ((bytes - 12) % 264, 0U);
  std::string stream = std::string(1, '\x0b') + std::string(12, '\0');
  for (std::size_t at = 12; at < bytes; at += 264) stream += std::string("\xe0\xff\0", 3);
  const std::uint32_t sizes[] = {static_cast<std::uint32_t>(stream.size()),
                                 static_cast<std::uint32_t>(bytes)};
  std::string head(sizeof sizes, '\0');
  std::memcpy(head.data(), sizes, sizeof sizes);
  return fmt::format(
             "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {}\nHEIGHT 1\n"
             "POINTS {}\nDATA binary_compressed\n",
             points, points) +
         head + stream;
}

TEST(Budget, CompressedZerosTakeNoGigabytes) {
  const Expected<PointCloud> few = ParseCloud(CompressedZeros(22 * 20'000 + 1), "f.pcd");
  ASSERT_TRUE(few) << few.error().message;
  EXPECT_EQ(few->points.size(), 440'001U);
  const std::string many = CompressedZeros(22 * 909'090 + 1);
  EXPECT_LT(many.size(), 3'000'000U);
  const ChildCost cost = CostOf([&many] {
    const Expected<PointCloud> cloud = ParseCloud(many, "f.pcd");
    return !cloud &&
           cloud.error().message.find("Save the scan as DATA binary") != std::string::npos;
  });
  EXPECT_TRUE(cost.ended);
  EXPECT_LT(cost.peak_bytes, 16 * kMiB);
}

TEST(Budget, HeadersThatPromiseManyPointsTakeNoMemory) {
  const std::string pcd =
      "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1000000000\nHEIGHT 1\n"
      "POINTS 1000000000\nDATA ";
  const std::string ply =
      " 1.0\nelement face 4000000000\nproperty list uint int vertex_indices\n"
      "element vertex 9000000000000\nproperty float x\nproperty float y\nproperty float z\n"
      "end_header\n";
  for (const auto& [text, name] :
       {std::pair{pcd + "ascii\n1 2 3\n", "a.pcd"},
        {pcd + "binary\n0123456789ab", "b.pcd"},
        {pcd + "binary_compressed\n" + std::string(20, '\x7f'), "c.pcd"},
        {"ply\nformat ascii" + ply + "4000000000 1 2\n", "d.ply"},
        {"ply\nformat binary_little_endian" + ply + std::string(40, '\x7f'), "e.ply"},
        {"x,y,z" + std::string(900, ',') + "\n1,2,3\n", "f.csv"}}) {
    const ChildCost cost =
        CostOf([&text = text, &name = name] { return !ParseCloud(text, name).has_value(); });
    EXPECT_TRUE(cost.ended) << name;
    EXPECT_LT(cost.peak_bytes, 8 * kMiB) << name;
    EXPECT_LT(cost.seconds, 1.0) << name;
  }
}

// A chain of frames from the LiDAR to the camera, and odometry that branches off.
std::string ChainOfFrames(int frames) {
  const auto transform = [](const std::string& parent, const std::string& child, int x_m) {
    return fmt::format(
        " - {{header: {{frame_id: {}}}, child_frame_id: {}, transform: {{translation: {{x: {}, y: "
        "0, "
        "z: 0}}, rotation: {{x: 0, y: 0, z: 0, w: 1}}}}}}\n",
        parent, child, x_m);
  };
  const auto name = [&](int i) {
    return i == 0 ? std::string("lidar") : i == frames ? "camera_optical" : fmt::format("f{}", i);
  };
  std::string text = "transforms:\n";
  for (int i = 1; i <= frames; ++i) text += transform(name(i - 1), name(i), 0);
  for (int i = 0; i < frames; ++i) text += transform(name(frames / 2), "odom", i);
  return text;
}

TEST(Budget, PosesOfManyFramesTakeNoQuadraticTime) {
  const std::string text = ChainOfFrames(20'000);
  const ChildCost cost = CostOf([&text] { return ParsePose(text, "f.yaml").has_value(); });
  EXPECT_TRUE(cost.ended);
  EXPECT_LT(cost.seconds, 20.0);
  EXPECT_LT(cost.peak_bytes, 20 * text.size() + 64 * kMiB);
  std::string launch = "from launch import LaunchDescription\n# static_transform_publisher\n";
  while (launch.size() < 8 * kMiB) launch += "arguments=[0 0 0 0 0 0 lidar camera_optical]\n";
  EXPECT_LT(CostOf([&launch] {
              static_cast<void>(ParsePose(launch, "f.launch.py"));
              return true;
            }).seconds,
            20.0);
}

// Each observation of n pixels has a covariance of 32 n^2 bytes.
TEST(Budget, PixelsOfRigsTakeNoGigabytes) {
  constexpr int kPoints = 1000;
  std::string points = "0, 0";
  for (int i = 1; i < kPoints; ++i) points += fmt::format(", 0.{:03}, 0", i);
  std::string text =
      "sextant_rig: 1\nsensors:\n  - name: cam\n    camera: {model: pinhole, fx_px: 700, fy_px: "
      "700, "
      "cx_px: 640, cy_px: 360}\n  - name: lidar\nboards:\n  - {id: 0, top_right_m: 2, "
      "right_bottom_m: 2, points_m: [" +
      points + "]}\nmoments:\n";
  for (int i = 0; i < 40; ++i) {
    text += "  - observations: [{sensor: cam, board: 0, pixels: [" + points + "]}]\n";
  }
  const ChildCost cost = CostOf([&text] {
    const Expected<RigFile> rig = ParseRigFile(text, "f.yaml");
    return !rig && rig.error().message.find("expected fewer pixels") != std::string::npos;
  });
  EXPECT_TRUE(cost.ended);
  EXPECT_LT(cost.peak_bytes, 20 * text.size() + 64 * kMiB);
}

}  // namespace
}  // namespace sextant
