// SPDX-License-Identifier: Apache-2.0
#include "io/problem_yaml.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/random_vectors.h"
#include "geometry/so3.h"
#include "support/bad_text.h"
#include "support/scenes.h"

namespace sextant {
namespace {

using test::BadText;
using test::Repeated;
using testing::HasSubstr;

Rigid3d RandomPose(Random& random) {
  const Eigen::Quaterniond rotation = ExpSo3(NormalVector(random));
  return {rotation, NormalVector(random)};
}

ProblemFile FullProblem(Random& random) {
  ProblemFile file;
  file.problem = test::MakeScene({.pairs = 8, .sigma_m = 0.01, .sigma_px = 0.7}, random).problem;
  file.problem.camera->model = CameraModel::kBrownConrady;
  file.problem.camera->distortion = {-0.1, 0.01, 1e-3, 1.0 / 3.0, 0.0, 0.0, 0.0, 5e-324};
  file.problem.boards = {{.id = 0, .top_right_m = 0.468, .right_bottom_m = 0.484},
                         {.id = 26, .top_right_m = 0.1, .right_bottom_m = 0.7}};
  file.problem.pairs_3d3d[2].covariance_in_cam = Eigen::Vector3d(1e-4, 2e-5, 3e-6).asDiagonal();
  file.problem.pairs_3d3d[3].id = {.view = 7, .board = 582, .corner = 2};
  file.problem.point_sets.in_lidar.push_back({1.0, 2.0, 3.0});
  file.problem.initial_cam_from_lidar = RandomPose(random);
  file.true_cam_from_lidar = RandomPose(random);
  file.comment = "made by \"hand\": # 1\n\ttwo\\lines, \xc3\xa9";
  return file;
}

TEST(ProblemYaml, RoundTripsToTheBit) {
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const ProblemFile file = FullProblem(random);
    const std::string text = FormatProblemYaml(file);
    const Expected<ProblemFile> read = ParseProblemYaml(text, "p.yaml");
    ASSERT_TRUE(read) << read.error().message << text;
    const CalibrationProblem& a = file.problem;
    const CalibrationProblem& b = read->problem;
    EXPECT_EQ(read->comment, file.comment);
    ASSERT_TRUE(b.camera && b.initial_cam_from_lidar && read->true_cam_from_lidar);
    EXPECT_EQ(b.camera->distortion, a.camera->distortion);
    ASSERT_EQ(b.pairs_3d3d.size(), a.pairs_3d3d.size());
    for (std::size_t i = 0; i < a.pairs_3d3d.size(); ++i) {
      EXPECT_EQ(b.pairs_3d3d[i].point_in_cam, a.pairs_3d3d[i].point_in_cam);
      EXPECT_EQ(b.pairs_3d3d[i].id, a.pairs_3d3d[i].id);
      EXPECT_EQ(b.pairs_3d3d[i].covariance_in_cam, a.pairs_3d3d[i].covariance_in_cam);
    }
    EXPECT_EQ(b.pairs_2d3d[5].pixel, a.pairs_2d3d[5].pixel);
    EXPECT_EQ(b.pairs_2d3d[5].sigma_px, a.pairs_2d3d[5].sigma_px);
    EXPECT_EQ(b.point_sets.in_lidar, a.point_sets.in_lidar);
    EXPECT_EQ(b.boards[1].right_bottom_m, 0.7);
    EXPECT_EQ(read->true_cam_from_lidar->rotation.coeffs(),
              file.true_cam_from_lidar->rotation.coeffs());
    EXPECT_EQ(FormatProblemYaml(*read), text);
  }
}

TEST(ProblemYaml, PointSetsFollowThePairsUnlessTheyAreGiven) {
  Random random(2);
  ProblemFile file;
  file.problem = test::MakeScene({.pairs = 5}, random).problem;
  const Expected<ProblemFile> implied = ParseProblemYaml(FormatProblemYaml(file), "p");
  EXPECT_THAT(FormatProblemYaml(file), testing::Not(HasSubstr("point_sets")));
  EXPECT_EQ(implied->problem.point_sets.in_cam, file.problem.point_sets.in_cam);
  file.problem.point_sets = {};
  const Expected<ProblemFile> empty = ParseProblemYaml(FormatProblemYaml(file), "p");
  EXPECT_TRUE(empty->problem.point_sets.in_cam.empty());
}

TEST(ProblemYaml, ReadsWhatAHandWouldWrite) {
  const Expected<ProblemFile> read = ParseProblemYaml(R"(
# Two corners
sextant_problem: 1
initial_cam_from_lidar:
  matrix:
    - [0, -1,  0, 0.1]
    - [0,  0, -1, 0.2]
    - [1,  0,  0, 0.3]
    - [0,  0,  0, 1]
pairs_3d3d:
  - {point_in_cam: [1, 2, 3.5], point_in_lidar: [+4, 5e0, 6.]}
  - {point_in_cam: [1, 2, 3], point_in_lidar: [4, 5, 6], id: {board: 3, corner: 1}}
)",
                                                      "p.yaml");
  ASSERT_TRUE(read) << read.error().message;
  const Eigen::Vector3d ahead = *read->problem.initial_cam_from_lidar * Eigen::Vector3d(2, 0, 0);
  EXPECT_LT((ahead - Eigen::Vector3d(0.1, 0.2, 2.3)).norm(), 1e-15);
  EXPECT_EQ(read->problem.pairs_3d3d[0].point_in_lidar, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(read->problem.pairs_3d3d[1].id, (PairId{.view = 0, .board = 3, .corner = 1}));
}

class BadYamlTest : public testing::TestWithParam<BadText> {};

TEST_P(BadYamlTest, EndsInOneLineThatSaysWhereAndWhat) {
  ExpectRefused(ParseProblemYaml(GetParam().text, "p.yaml"), GetParam());
}

std::string Problem(const std::string& rest) { return "sextant_problem: 1\n" + rest; }

std::string BillionLaughs() {
  std::string text = "a0: &a0 [x]\n";
  for (int i = 1; i < 40; ++i) text += fmt::format("a{0}: &a{0} [*a{1}, *a{1}]\n", i, i - 1);
  return text;
}

using ErrorCode::kParse;

INSTANTIATE_TEST_SUITE_P(
    Inputs, BadYamlTest,
    testing::Values(
        BadText{"Empty", "", kParse, "p.yaml:1: the file is empty"},
        BadText{"NotAMap", "[1, 2]", kParse, "p.yaml:1: sextant_problem: expected a map"},
        BadText{"NoHeader", "camera_matrix: 1", kParse, "expected a problem file with the key"},
        BadText{"WrongVersion", "sextant_problem: 2", kParse, "from 1 to 1, got '2'"},
        BadText{"UnknownKey", Problem("pairs_3d2d: []"), kParse,
                "p.yaml:2: sextant_problem: unknown key 'pairs_3d2d'; did you mean 'pairs_3d3d'?"},
        BadText{"UnknownInnerKey",
                Problem("pairs_3d3d:\n  - {point_in_cam: [1,2,3], point_in_lidr: [1,2,3]}"), kParse,
                "p.yaml:3: pairs_3d3d: unknown key 'point_in_lidr'; did you mean"},
        BadText{"MissingKey", Problem("pairs_3d3d:\n  - {point_in_cam: [1,2,3]}"), kParse,
                "p.yaml:3: point_in_lidar: expected this key"},
        BadText{"RepeatedKey", Problem("comment: a\ncomment: b"), kParse,
                "p.yaml:3: not valid YAML: the key 'comment' stands here a second time"},
        BadText{"TwoNumbers",
                Problem("pairs_3d3d:\n  - {point_in_cam: [1,2], point_in_lidar: [1,2,3]}"), kParse,
                "p.yaml:3: point_in_cam: expected 3 numbers, got 2"},
        BadText{"DecimalComma",
                Problem("pairs_3d3d:\n- {point_in_cam: ['0,5',1,2], point_in_lidar: [1,2,3]}"),
                kParse, "decimal comma?"},
        BadText{"NotANumber",
                Problem("pairs_3d3d:\n- point_in_cam: [1,\n .nan,2]\n  point_in_lidar: [1,2,3]"),
                ErrorCode::kNonFinite, "p.yaml:4: point_in_cam: expected a finite number"},
        BadText{"Infinite",
                Problem("pairs_3d3d:\n- {point_in_cam: [1,2,-.INF], point_in_lidar: [1,2,3]}"),
                ErrorCode::kNonFinite, "got '-.INF'"},
        BadText{"NegativeSigma",
                Problem("pairs_2d3d:\n- {pixel: [1,2], point_in_lidar: [1,2,3], sigma_px: -1}"),
                kParse, "p.yaml:3: sigma_px: expected zero or more, got -1"},
        BadText{"NotARotation",
                Problem("initial_cam_from_lidar: {matrix: [[2,0,0,0],[0,1,0,0],[0,0,1,0],"
                        "[0,0,0,1]]}"),
                kParse, "p.yaml:2: matrix: expected a rotation"},
        BadText{"Mirror",
                Problem("initial_cam_from_lidar: {matrix: [[-1,0,0,0],[0,1,0,0],[0,0,1,0],"
                        "[0,0,0,1]]}"),
                kParse, "expected a rotation"},
        BadText{"ZeroQuaternion",
                Problem("truth: {cam_from_lidar: {translation_m: [0,0,0], quaternion_wxyz: "
                        "[0,0,0,0]}}"),
                kParse, "quaternion_wxyz: expected length 1, got 0"},
        BadText{"UnknownModel", Problem("camera: {model: fisheye, fx_px: 1}"), kParse,
                "p.yaml:2: model: expected pinhole or brown_conrady or equidistant"},
        BadText{"ListForMap", Problem("camera: []"), kParse, "camera: expected a map, got a list"},
        BadText{"MapForNumber",
                Problem("pairs_2d3d:\n- {pixel: [{a: 1}, 2], point_in_lidar: [1,2,3]}"), kParse,
                "pixel: expected a number, got a map"},
        BadText{"Syntax", Problem("boards: [1, 2"), kParse, "not valid YAML"},
        BadText{"Tab", Problem("camera:\n\tmodel: pinhole"), kParse, "not valid YAML"},
        BadText{"SecondDocument", Problem("--- \n a: 1"), kParse, "expected one YAML document"},
        BadText{"DeepFlow", Problem("comment: " + Repeated("[\n", 100'000)), kParse,
                "p.yaml:3: not valid YAML"},
        BadText{"DeepMaps", Problem("comment: " + Repeated("{a: ", 100'000)), kParse,
                "nested deeper than 16 levels"},
        BadText{"DeepBlocks", Problem("comment:\n" + Repeated("- ", 100'000)), kParse,
                "nested deeper than 16 levels"},
        BadText{"BillionLaughs", BillionLaughs(), kParse, "aliases (*name) are not supported"},
        BadText{"MapAsKey", "? {a: b}\n: c", kParse, "expected a plain key"},
        BadText{"ZeroByte", Problem(std::string("comment: a\0b", 12)), kParse,
                "p.yaml:2: expected text, got a zero byte"},
        BadText{"Junk", "\x7f\x45LF\x02\xff\xfe", kParse, "p.yaml"}),
    [](const auto& bad) { return bad.param.name; });

}  // namespace
}  // namespace sextant
