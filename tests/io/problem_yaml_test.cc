// SPDX-License-Identifier: Apache-2.0
#include "io/problems/problem_yaml.h"

#include <fmt/core.h>
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
  file.comment = "made by \"hand\": # 1 two\\lines, \xc3\xa9";
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

BoardView FullView(Random& random, int view) {
  BoardView full{.view = view, .board = 26};
  full.cam_from_board = RandomPose(random);
  full.lidar_from_board = RandomPose(random);
  for (const int count : {4, 1}) {
    BoardPoints& printed = full.printed.emplace_back();
    for (int i = 0; i < count; ++i) {
      printed.in_board_m.emplace_back(NormalVector(random).head<2>());
      printed.pixels.emplace_back(NormalVector(random).head<2>());
    }
    const Eigen::VectorXd factor = Eigen::VectorXd::Constant(2 * count, random.Normal());
    printed.covariance_px2 = factor * factor.transpose();
    printed.covariance_px2.diagonal().array() += 1.0 / 3.0;
  }
  full.range_sigma_m = 0.01 / 3.0;
  for (int i = 0; i < 5; ++i) full.face_in_lidar.push_back(NormalVector(random));
  for (const int side : {0, 3, 7}) {
    full.edges.push_back(
        {.direction = NormalVector(random).normalized(), .side = side, .sigma_m = 0.002});
  }
  return full;
}

TEST(ProblemYaml, BoardViewsRoundTripToTheBit) {
  Random random(4);
  ProblemFile file = FullProblem(random);
  file.problem.boards[1].hole =
      BoardHole{.width_m = 0.05, .height_m = 0.2, .center_in_board_m = {0.01, 1.0 / 30.0}};
  file.problem.board_views = {FullView(random, 0), FullView(random, 3)};
  file.problem.board_views[1].face_in_lidar.clear();
  file.problem.board_views[1].range_sigma_m = 0.0;
  file.problem.board_views[1].edges.clear();
  const std::string text = FormatProblemYaml(file);
  const Expected<ProblemFile> read = ParseProblemYaml(text, "p.yaml");
  ASSERT_TRUE(read) << read.error().message << text;
  ASSERT_TRUE(read->problem.boards[1].hole);
  EXPECT_EQ(read->problem.boards[1].hole->center_in_board_m,
            file.problem.boards[1].hole->center_in_board_m);
  ASSERT_EQ(read->problem.board_views.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const BoardView& a = file.problem.board_views[i];
    const BoardView& b = read->problem.board_views[i];
    EXPECT_EQ(b.view, a.view);
    EXPECT_EQ(b.board, a.board);
    EXPECT_EQ(b.range_sigma_m, a.range_sigma_m);
    EXPECT_EQ(b.face_in_lidar, a.face_in_lidar);
    EXPECT_EQ(b.cam_from_board.translation, a.cam_from_board.translation);
    EXPECT_EQ(b.lidar_from_board.rotation.coeffs(), a.lidar_from_board.rotation.coeffs());
    ASSERT_EQ(b.printed.size(), a.printed.size());
    for (std::size_t k = 0; k < a.printed.size(); ++k) {
      EXPECT_EQ(b.printed[k].in_board_m, a.printed[k].in_board_m);
      EXPECT_EQ(b.printed[k].pixels, a.printed[k].pixels);
      EXPECT_EQ(b.printed[k].covariance_px2, a.printed[k].covariance_px2);
    }
    ASSERT_EQ(b.edges.size(), a.edges.size());
    for (std::size_t k = 0; k < a.edges.size(); ++k) {
      EXPECT_EQ(b.edges[k].direction, a.edges[k].direction);
      EXPECT_EQ(b.edges[k].side, a.edges[k].side);
      EXPECT_EQ(b.edges[k].sigma_m, a.edges[k].sigma_m);
    }
  }
  EXPECT_EQ(FormatProblemYaml(*read), text);
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

TEST(ProblemYaml, ReadsHandWrittenFiles) {
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

// A view with valid poses.
std::string View(const std::string& rest) {
  return Problem(
      "boards:\n  - {id: 0, top_right_m: 0.5, right_bottom_m: 0.5}\n"
      "board_views:\n  - view: 0\n    board: 0\n"
      "    cam_from_board: {translation_m: [0, 0, 2], quaternion_wxyz: [1, 0, 0, 0]}\n"
      "    lidar_from_board: {translation_m: [2, 0, 0], quaternion_wxyz: [1, 0, 0, 0]}\n" +
      rest);
}

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
        BadText{"NoHeader", "camera_matrix: 1", kParse, "expected a problem file, with the key"},
        BadText{"WrongVersion", "sextant_problem: 2", kParse, "expected 1, got '2'"},
        BadText{"UnknownKey", Problem("pairs_3d2d: []"), kParse,
                "p.yaml:2: sextant_problem: unknown key 'pairs_3d2d'; did you mean 'pairs_3d3d'?"},
        BadText{"UnknownInnerKey",
                Problem("pairs_3d3d:\n  - {point_in_cam: [1,2,3], point_in_lidr: [1,2,3]}"), kParse,
                "p.yaml:3: pairs_3d3d: unknown key 'point_in_lidr'; did you mean"},
        BadText{"MissingKey", Problem("pairs_3d3d:\n  - {point_in_cam: [1,2,3]}"), kParse,
                "p.yaml:3: point_in_lidar: expected this key"},
        BadText{"RepeatedKey", Problem("comment: a\ncomment: b"), kParse,
                "p.yaml:3: not valid YAML: the key 'comment' appears twice"},
        BadText{"TwoNumbers",
                Problem("pairs_3d3d:\n  - {point_in_cam: [1,2], point_in_lidar: [1,2,3]}"), kParse,
                "p.yaml:3: point_in_cam: expected 3 numbers, got 2"},
        BadText{"ViewOfNoBoard",
                Problem("board_views:\n  - {view: 0, board: 5, printed: [], cam_from_board: "
                        "{translation_m: [0,0,2], quaternion_wxyz: [1,0,0,0]}, lidar_from_board: "
                        "{translation_m: [2,0,0], quaternion_wxyz: [1,0,0,0]}}"),
                kParse, "p.yaml:3: board_views: view 0 names board 5, which is not among"},
        BadText{"ViewWithoutPrinted", View(""), kParse, "p.yaml:5: printed: expected this key"},
        BadText{"UnknownKeyOfView", View("    printed: []\n    faces_in_lidar: []"), kParse,
                "unknown key 'faces_in_lidar'; did you mean 'face_in_lidar'?"},
        BadText{"OddPixels",
                View("    printed:\n      - {in_board_m: [0, 0], pixels: [1, 2, 3], "
                     "covariance_px2: [1, 0, 0, 1]}"),
                kParse, "p.yaml:10: pixels: expected two numbers per point, got 3 numbers"},
        BadText{"SmallCovariance",
                View("    printed:\n      - {in_board_m: [0, 0], pixels: [1, 2], "
                     "covariance_px2: [1, 0]}"),
                kParse, "p.yaml:10: covariance_px2: expected 4 numbers, got 2"},
        BadText{"NegativeCovariance",
                View("    printed:\n      - {in_board_m: [0, 0], pixels: [1, 2], "
                     "covariance_px2: [-1, 0, 0, 1]}"),
                kParse, "p.yaml:5: board_views: board 0 of view 0 has a covariance of pixels that"},
        BadText{"FaceWithoutSigma", View("    printed: []\n    face_in_lidar:\n      - [1, 2, 3]"),
                kParse, "range_sigma_m: expected this key"},
        BadText{"EdgeOfNoSide",
                View("    printed: []\n    edges:\n      - {direction: [1, 0, 0], side: -1, "
                     "sigma_m: 0.01}"),
                kParse, "p.yaml:11: side: expected"},
        BadText{"EdgeOfTheHoleOfAWholeBoard",
                View("    printed: []\n    edges:\n      - {direction: [1, 0, 0], side: 4, "
                     "sigma_m: 0.01}"),
                kParse, "board 0 of view 0 has an edge ray of side 4, which board 0 does not have"},
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
        BadText{"DeepMaps", Problem("comment: " + Repeated("{a: ", 10'000)), kParse,
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
