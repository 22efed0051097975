// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/polygon_edges.h"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <ostream>
#include <string>

#include "eval/extractors/board_scenes.h"
#include "features/lidar/corner_extractor.h"
#include "io/clouds/pcd_file.h"
#include "io/problems/acfr_poses.h"
#include "support/acfr_boards.h"
#include "support/drawn_board.h"
#include "support/median.h"
#include "support/real_data.h"

namespace sextant::test {
namespace {

using testing::HasSubstr;

constexpr double kMargin_m = 0.05;

ScanMarks Projection() {
  return {.camera = AssumedCamera(1280, 720), .cam_from_lidar = AxesCamFromLidar()};
}

// All boards of a scene, as a person would draw them.
ScanMarks DrawScene(const Scene& scene) {
  ScanMarks marks = Projection();
  for (const SceneBoard& board : scene.boards) {
    marks.boards.push_back(
        DrawBoard(board.board.id, CornersOf(board, {}), Projection(), kMargin_m));
  }
  return marks;
}

// A VLP-16 whose rings have no biases, which no estimator can observe.
ScanRings RingsOf(const Scene& scene, std::uint64_t seed, double sigma_m = 0.01) {
  LidarModel model = Model("vlp16");
  model.range_sigma_m = sigma_m;
  model.ring_bias_sigma_m = 0.0;
  return *ScanRings::Build(Scan(scene, model, {.seed = seed}).cloud);
}

Scene NumberedBoards(Scene scene) {
  int id = 7;
  for (SceneBoard& board : scene.boards) board.board.id = id++;
  return scene;
}

std::vector<double> ErrorsOf(const Expected<LidarCorners>& corners, const SceneBoard& board) {
  std::vector<double> errors;
  EXPECT_TRUE(corners) << corners.error().message;
  for (int i = 0; corners && i < kCornersPerBoard; ++i) {
    errors.push_back(
        (corners->in_lidar[static_cast<std::size_t>(i)] - TrueCorner(board, i)).norm());
  }
  return errors;
}

// The paper's set-up, as in boards_in_scans_test.cc, with the same bounds: marked boards are as
// accurate as those that the search finds.
TEST(PolygonEdges, EveryExtractorIsAsAccurateAsOnBoardsThatWereFound) {
  std::map<std::string, std::vector<double>> errors;
  for (std::uint64_t i = 0; i < 40; ++i) {
    Random random(DeriveSeed(1, "polygon_edges", 0, i));
    const Scene scene = NumberedBoards(TwoBoardsInRoom({.distance_m = 1.8}, random));
    const std::vector<Board> boards = BoardsIn(scene);
    const auto patches = PatchesFromPolygons(RingsOf(scene, i), DrawScene(scene), boards);
    ASSERT_TRUE(patches) << i << ": " << patches.error().message;
    ASSERT_EQ(patches->size(), 2U);
    for (const BoardPatch& patch : *patches) {
      const auto b = static_cast<std::size_t>(patch.board);
      for (const CornerExtractorInfo& extractor : CornerExtractors()) {
        const std::vector<double> of =
            ErrorsOf(ExtractCorners(extractor.name, patch, boards[b]), scene.boards[b]);
        errors[extractor.name].insert(errors[extractor.name].end(), of.begin(), of.end());
      }
    }
  }
  for (const auto& [name, of] : errors) {
    RecordProperty(name + "_median_um", static_cast<int>(1e6 * Median(of)));
  }
  EXPECT_LT(Median(errors["rectangle"]), 0.0025);
  EXPECT_LT(Median(errors["plane_lines"]), 0.0055);
  EXPECT_GT(Median(errors["lines3d"]), 0.008);
  EXPECT_LT(Median(errors["lines3d"]), 0.016);
}

TEST(PolygonEdges, ASquareBoardIsNumberedFromTheEdgeThatWasDrawnFirst) {
  const Scene scene = PlacedBoards(1);
  const ScanRings rings = RingsOf(scene, 1, 0.001);
  ScanMarks marks = DrawScene(scene);
  for (int turns = 0; turns < 4; ++turns) {
    const auto patches = PatchesFromPolygons(rings, marks, BoardsIn(scene));
    ASSERT_TRUE(patches) << patches.error().message;
    for (const char* extractor : {"rectangle", "plane_lines", "lines3d"}) {
      const auto corners = ExtractCorners(extractor, patches->front(), scene.boards.front().board);
      ASSERT_TRUE(corners) << corners.error().message;
      for (int i = 0; i < 4; ++i) {
        const Eigen::Vector3d truth = TrueCorner(scene.boards.front(), (i + turns) % 4);
        EXPECT_LT((corners->in_lidar[static_cast<std::size_t>(i)] - truth).norm(), 0.02)
            << extractor << " " << turns << " " << i;
      }
    }
    std::vector<Quadrilateral>& edges = marks.boards.front().edges;
    std::rotate(edges.begin(), edges.begin() + 1, edges.end());
  }
}

TEST(PolygonEdges, AnOblongBoardDrawnFromTheWrongEdgeIsRefused) {
  Scene scene = PlacedBoards(1);
  scene.boards[0].board.top_right_m = 0.4;
  scene.boards[0].board.right_bottom_m = 0.6;
  const ScanRings rings = RingsOf(scene, 2);
  ScanMarks marks = DrawScene(scene);
  const auto right = PatchesFromPolygons(rings, marks, BoardsIn(scene));
  ASSERT_TRUE(right) << right.error().message;
  EXPECT_LT(Median(ErrorsOf(ExtractCorners("rectangle", right->front(), scene.boards[0].board),
                            scene.boards[0])),
            0.01);
  std::vector<Quadrilateral>& edges = marks.boards.front().edges;
  std::rotate(edges.begin(), edges.begin() + 1, edges.end());
  const auto wrong = PatchesFromPolygons(rings, marks, BoardsIn(scene));
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code, ErrorCode::kInvalidInput);
  EXPECT_THAT(wrong.error().message, HasSubstr("fit in exchanged order"));
}

// A strip in the board's own plane that continues beyond its lower right edge, like a stand: the
// rings do not end there.
TEST(PolygonEdges, ARingThatContinuesInThePlaneHasNoEndThere) {
  Scene scene = PlacedBoards(1);
  const Rigid3d& pose = scene.boards[0].world_from_board;
  scene.walls.push_back(Wall(
      "stand", pose * Rigid3d{Eigen::Quaterniond::Identity(), {0.24, 0.05, 0.002}}, 0.4, 0.09));
  const auto patches = PatchesFromPolygons(RingsOf(scene, 3), DrawScene(scene), BoardsIn(scene));
  ASSERT_TRUE(patches) << patches.error().message;
  for (const EdgePoint& edge : patches->front().edges) {
    const Eigen::Vector3d in_board = pose.Inverse() * patches->front().plane.At(edge.in_plane);
    EXPECT_LT(in_board.head<2>().cwiseAbs().maxCoeff(), 0.24 + 0.015) << in_board.transpose();
  }
  // The corners of a full board have a median error of 2.2 mm; here an edge lacks half of its ends.
  const std::vector<double> errors = ErrorsOf(
      ExtractCorners("rectangle", patches->front(), scene.boards[0].board), scene.boards[0]);
  EXPECT_LT(*std::ranges::max_element(errors), 0.012);
}

TEST(PolygonEdges, AHollowBoardGivesEightCorners) {
  Scene scene = PlacedBoards(1);
  Board& board = scene.boards[0].board;
  board.top_right_m = 0.9;
  board.right_bottom_m = 0.9;
  board.hole = BoardHole{.width_m = 0.5, .height_m = 0.5};
  const auto patches = PatchesFromPolygons(RingsOf(scene, 4), DrawScene(scene), BoardsIn(scene));
  ASSERT_TRUE(patches) << patches.error().message;
  for (const char* extractor : {"rectangle", "plane_lines"}) {
    const auto corners = ExtractCorners(extractor, patches->front(), board);
    ASSERT_TRUE(corners) << corners.error().message;
    ASSERT_EQ(corners->in_lidar.size(), 8U);
    EXPECT_LT(Median(ErrorsOf(corners, scene.boards[0])), 0.01) << extractor;
  }
}

// Three times the paper's noise: the thresholds scale with it.
TEST(PolygonEdges, NoisyRangesAreTolerated) {
  std::vector<double> errors;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Scene scene = PlacedBoards(2);
    const auto patches =
        PatchesFromPolygons(RingsOf(scene, seed, 0.03), DrawScene(scene), BoardsIn(scene));
    ASSERT_TRUE(patches) << patches.error().message;
    for (const BoardPatch& patch : *patches) {
      const SceneBoard& board = scene.boards[static_cast<std::size_t>(patch.board)];
      const std::vector<double> of =
          ErrorsOf(ExtractCorners("rectangle", patch, board.board), board);
      errors.insert(errors.end(), of.begin(), of.end());
    }
  }
  RecordProperty("rectangle_median_um", static_cast<int>(1e6 * Median(errors)));
  // In proportion to the noise: 2.2 mm at 1 cm.
  EXPECT_LT(Median(errors), 0.0075);
}

struct BadMarks {
  const char* name;
  void (*spoil)(ScanMarks& marks, std::vector<Board>& boards);
  ErrorCode code;
  const char* message;
};

void PrintTo(const BadMarks& bad, std::ostream* out) { *out << bad.name; }

class BadMarksTest : public testing::TestWithParam<BadMarks> {};

TEST_P(BadMarksTest, AreRefusedByBoardAndEdge) {
  const Scene scene = PlacedBoards(2);
  ScanMarks marks = DrawScene(scene);
  std::vector<Board> boards = BoardsIn(scene);
  GetParam().spoil(marks, boards);
  const auto patches = PatchesFromPolygons(RingsOf(scene, 5), marks, boards);
  ASSERT_FALSE(patches);
  EXPECT_EQ(ToString(patches.error().code), ToString(GetParam().code)) << patches.error().message;
  EXPECT_THAT(patches.error().message, HasSubstr(GetParam().message));
}

void Shift(Quadrilateral& area, const Eigen::Vector2d& by) {
  for (Eigen::Vector2d& pixel : area) pixel += by;
}

INSTANTIATE_TEST_SUITE_P(
    Marks, BadMarksTest,
    testing::Values(
        BadMarks{"Nothing", [](ScanMarks& m, std::vector<Board>&) { m.boards.clear(); },
                 ErrorCode::kMissingData, "no board is marked"},
        BadMarks{"ThreeEdges",
                 [](ScanMarks& m, std::vector<Board>&) { m.boards[1].edges.pop_back(); },
                 ErrorCode::kMissingData, "board 1: 3 of its 4 edges are marked"},
        BadMarks{"UnknownBoard", [](ScanMarks& m, std::vector<Board>&) { m.boards[1].id = 5; },
                 ErrorCode::kInvalidInput, "board 5 is marked, but its size is not known"},
        BadMarks{"NoSize", [](ScanMarks&, std::vector<Board>& b) { b[0].top_right_m = 0.0; },
                 ErrorCode::kInvalidInput, "board 0 is marked, but its size is not known"},
        BadMarks{"OutOfTheScan",
                 [](ScanMarks& m, std::vector<Board>&) {
                   for (Quadrilateral& area : m.boards[0].edges) Shift(area, {0, -5000});
                 },
                 ErrorCode::kDegenerate, "board 0: no plane of the 0 returns within its areas"},
        BadMarks{"OnTheWall",
                 [](ScanMarks& m, std::vector<Board>&) {
                   for (Quadrilateral& area : m.boards[0].edges) Shift(area, {180, 0});
                 },
                 ErrorCode::kTooFewPairs, "board 0: no ring ends on it within its top-left area"},
        BadMarks{"WithinTheBoard",
                 [](ScanMarks& m, std::vector<Board>&) {
                   Shift(m.boards[0].edges[2], {-40, -40});
                 },
                 ErrorCode::kTooFewPairs,
                 "board 0: no ring ends on it within its bottom-right area"}),
    [](const auto& bad) { return bad.param.name; });

// The corners top, right, bottom and left as seen by the sensor, each with the side after it.
BoardCorners Seen(const BoardCorners& corners, Board& board) {
  const auto height = [](const Eigen::Vector3d& point) { return point.z() / point.norm(); };
  const auto azimuth = [](const Eigen::Vector3d& p) { return std::atan2(p.y(), p.x()); };
  BoardCorners seen = corners;
  std::rotate(seen.begin(), std::ranges::max_element(seen, {}, height), seen.end());
  if (azimuth(seen[1]) > azimuth(seen[3])) std::swap(seen[1], seen[3]);
  const bool wide = (seen[1] - seen[0]).norm() > (seen[2] - seen[1]).norm();
  board.top_right_m = wide ? 0.85 : 0.61;
  board.right_bottom_m = wide ? 0.61 : 0.85;
  return seen;
}

TEST(PolygonEdges, RealBoardsMarkedAtTheirStoredCornersAgreeWithThem) {
  SEXTANT_REAL_DATA(folder, "acfr_vlp16");
  const Expected<std::vector<AcfrPose>> poses = ReadAcfrPoses(folder / "poses.csv");
  ASSERT_TRUE(poses) << poses.error().message;
  std::map<std::string, std::vector<double>> distances;
  for (const int id : kAcfrScans) {
    const Expected<PointCloud> cloud = ReadPcd(folder / fmt::format("full/pose{}.pcd", id));
    ASSERT_TRUE(cloud) << cloud.error().message;
    const auto pose = std::ranges::find(*poses, id, &AcfrPose::id);
    ASSERT_NE(pose, poses->end());
    Board board;
    const BoardCorners corners = Seen(pose->in_lidar.corners_m, board);
    ScanMarks marks = Projection();
    marks.boards = {DrawBoard(0, corners, Projection(), 0.08)};
    const std::vector<Board> boards = {board};
    const auto patches = PatchesFromPolygons(*ScanRings::Build(*cloud), marks, boards);
    ASSERT_TRUE(patches) << "pose " << id << ": " << patches.error().message;
    for (const char* extractor : {"rectangle", "plane_lines", "lines3d"}) {
      const auto found = ExtractCorners(extractor, patches->front(), board);
      ASSERT_TRUE(found) << "pose " << id << ": " << found.error().message;
      for (std::size_t i = 0; i < 4; ++i) {
        distances[extractor].push_back((found->in_lidar[i] - corners[i]).norm());
      }
    }
  }
  for (const auto& [name, of] : distances) {
    RecordProperty(name + "_median_um", static_cast<int>(1e6 * Median(of)));
    RecordProperty(name + "_largest_um", static_cast<int>(1e6 * *std::ranges::max_element(of)));
  }
  // The stored corners are results of another program, with a median of 11 mm from a crude fit.
  EXPECT_LT(Median(distances["rectangle"]), 0.020);
  EXPECT_LT(*std::ranges::max_element(distances["rectangle"]), 0.060);
  EXPECT_LT(Median(distances["plane_lines"]), 0.020);
  EXPECT_LT(Median(distances["lines3d"]), 0.030);
}

}  // namespace
}  // namespace sextant::test
