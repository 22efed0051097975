// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "eval/extractors/board_scenes.h"
#include "features/lidar/board_agreement.h"
#include "features/lidar/corner_extractor.h"
#include "geometry/board_check.h"
#include "geometry/symmetric.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/lidar/scan.h"
#include "support/median.h"

namespace sextant::test {
namespace {

struct Errors {
  std::vector<double> distances_m;
  std::vector<double> nees;  // For each board, per degree of freedom.
};

double Mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double StandardError(const std::vector<double>& values) {
  const double mean = Mean(values);
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size() * (values.size() - 1)));
}

LidarModel ModelWithSigma(const std::string& name, double sigma_m) {
  LidarModel model = *FindLidarModel(name);
  model.range_sigma_m = sigma_m;
  model.ring_bias_sigma_m = 0.0;  // No estimator can see it; its effect is a study of its own.
  return model;
}

BoardSearch SearchScan(const Scene& scene, const std::vector<Board>& boards,
                       const LidarModel& model, std::uint64_t seed) {
  const Expected<SimulatedScan> scan = SimulateScan(scene, model, {.seed = seed});
  if (!scan) {
    ADD_FAILURE() << scan.error().message;
    return {};
  }
  const Expected<ScanRings> rings = ScanRings::Build(scan->cloud);
  BoardSearchOptions options;
  options.beam = *FindLidarBeam(model.name);
  return *FindBoards(*rings, boards, options);
}

void AddErrors(const Scene& scene, const BoardSearch& search, const std::vector<Board>& boards,
               std::map<std::string, Errors>& errors) {
  for (const BoardPatch& patch : search.found) {
    const auto b = static_cast<std::size_t>(patch.board);
    for (const CornerExtractorInfo& extractor : CornerExtractors()) {
      const Expected<LidarCorners> corners = ExtractCorners(extractor.name, patch, boards[b]);
      ASSERT_TRUE(corners) << corners.error().message;
      Errors& of = errors[extractor.name];
      double nees = 0.0;
      for (int i = 0; i < kCornersPerBoard; ++i) {
        const Eigen::Vector3d off =
            corners->in_lidar[static_cast<std::size_t>(i)] - TrueCorner(scene.boards[b], i);
        of.distances_m.push_back(off.norm());
        nees += SquaredMahalanobis(off, corners->CovarianceOf(i)) / 3.0 / kCornersPerBoard;
      }
      of.nees.push_back(nees);
    }
  }
}

// The paper's set-up: VLP-16, two 48 cm boards, 1.8 m, range sigma 1 cm.
TEST(BoardsInScans, UsingPlaneAndSizeReducesTheErrorAsStated) {
  constexpr int kScans = 60;
  const LidarModel model = ModelWithSigma("vlp16", 0.01);
  std::map<std::string, Errors> errors;
  for (int i = 0; i < kScans; ++i) {
    Random random(DeriveSeed(1, "boards_in_scans", 0, static_cast<std::uint64_t>(i)));
    const Scene scene = TwoBoardsInRoom({.distance_m = 1.8}, random);
    const std::vector<Board> boards = BoardsIn(scene);
    const BoardSearch search = SearchScan(scene, boards, model, static_cast<std::uint64_t>(i));
    ASSERT_EQ(search.found.size(), 2U) << "scan " << i;
    AddErrors(scene, search, boards, errors);
  }
  EXPECT_LT(Median(errors["rectangle"].distances_m), 0.0025);
  EXPECT_LT(Median(errors["plane_lines"].distances_m), 0.0055);
  // The paper's method is worse, as expected; if it were better, the ground truth would be wrong.
  EXPECT_GT(Median(errors["lines3d"].distances_m), 0.008);
  EXPECT_LT(Median(errors["lines3d"].distances_m), 0.016);
  // Uses the boards' means, because the four corners of a board share their errors.
  for (const auto& [name, of] : errors) {
    const double allowed = 2.0 * StandardError(of.nees);
    EXPECT_GT(Mean(of.nees), 0.8 - allowed) << name;
    EXPECT_LT(Mean(of.nees), 1.25 + allowed) << name;
    EXPECT_LT(allowed, 0.5) << name << ": too few scans for this limit";
  }
}

// For each board found, the largest distance of a corner from its true position, for `rectangle`.
std::vector<double> WorstCorners(const Scene& scene, const BoardSearch& search) {
  std::vector<double> worst;
  for (const BoardPatch& patch : search.found) {
    const SceneBoard& board = scene.boards[static_cast<std::size_t>(patch.board)];
    const Expected<LidarCorners> corners = ExtractCorners("rectangle", patch, board.board);
    if (!corners) {
      ADD_FAILURE() << corners.error().message;
      continue;
    }
    worst.push_back(0.0);
    for (int i = 0; i < kCornersPerBoard; ++i) {
      const Eigen::Vector3d off =
          corners->in_lidar[static_cast<std::size_t>(i)] - TrueCorner(board, i);
      worst.back() = std::max(worst.back(), off.norm());
    }
  }
  return worst;
}

// An opening beside the middle distinguishes both halves of a turn, without the image.
TEST(BoardsInScans, AnOpeningBesideTheMiddleTellsWhichWayRoundABoardIs) {
  Random random(1);
  Scene scene = TwoBoardsInRoom({}, random);
  Board board = scene.boards[0].board;
  board.tags.clear();
  board.checker.reset();
  board.top_right_m = 0.9;
  board.right_bottom_m = 0.7;
  board.hole =
      BoardHole{.width_m = 0.4, .height_m = 0.3, .center_in_board_m = Eigen::Vector2d(0.12, 0.08)};
  EXPECT_FALSE(HolesAllowTurns(board, 2));
  for (const double turn_deg : {40.0, 220.0}) {
    scene.boards = {PlaceBoard(board, {.distance_m = 2.2, .turn_deg = turn_deg})};
    const BoardSearch search = SearchScan(scene, {board}, *FindLidarModel("os1_64"), 1);
    ASSERT_EQ(search.found.size(), 1U) << turn_deg;
    EXPECT_LT(WorstCorners(scene, search).at(0), 0.03) << turn_deg;
  }
  board.hole->center_in_board_m.setZero();
  EXPECT_TRUE(HolesAllowTurns(board, 2));
}

// A square outline looks the same after a quarter turn, an oblong opening does not.
TEST(BoardsInScans, AnOblongOpeningTellsTheQuarterTurnsOfASquareBoard) {
  Random random(1);
  Scene scene = TwoBoardsInRoom({}, random);
  Board board = scene.boards[0].board;
  board.tags.clear();
  board.checker.reset();
  board.top_right_m = 0.8;
  board.right_bottom_m = 0.8;
  board.hole = BoardHole{.width_m = 0.5, .height_m = 0.25};
  EXPECT_TRUE(HolesAllowTurns(board, 2));
  EXPECT_FALSE(HolesAllowTurns(board, 1));
  for (const double turn_deg : {40.0, 130.0}) {
    scene.boards = {PlaceBoard(board, {.distance_m = 2.2, .turn_deg = turn_deg})};
    const BoardSearch search = SearchScan(scene, {board}, *FindLidarModel("os1_64"), 1);
    ASSERT_EQ(search.found.size(), 1U) << turn_deg;
    const Expected<LidarCorners> corners = ExtractCorners("rectangle", search.found[0], board);
    ASSERT_TRUE(corners) << corners.error().message;
    for (std::size_t i = kCornersPerBoard; i < 2 * kCornersPerBoard; ++i) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const Eigen::Vector2d& corner : CornersInBoard(board)) {
        const Eigen::Vector3d truth =
            scene.boards[0].world_from_board * Eigen::Vector3d(corner.x(), corner.y(), 0.0);
        nearest = std::min(nearest, (corners->in_lidar[i] - truth).norm());
      }
      EXPECT_LT(nearest, 0.03) << turn_deg << " " << i;
    }
  }
}

class EveryLidar : public testing::TestWithParam<std::string> {
 protected:
  void ExpectBoth(const Scene& scene, int scan, double most_off_m) const {
    const LidarModel model = *FindLidarModel(GetParam());
    const BoardSearch search =
        SearchScan(scene, BoardsIn(scene), model, static_cast<std::uint64_t>(scan));
    ASSERT_EQ(search.found.size(), 2U) << "scan " << scan;
    for (const double off : WorstCorners(scene, search)) {
      EXPECT_LT(off, most_off_m) << "scan " << scan;
    }
  }
};

TEST_P(EveryLidar, FindsBothBoards) {
  const BoardField field = FieldOf(*FindLidarModel(GetParam()), 1.8);
  for (int i = 0; i < 6; ++i) {
    Random random(DeriveSeed(2, GetParam(), 0, static_cast<std::uint64_t>(i)));
    ExpectBoth(TwoBoardsInRoom(field, random), i, 0.03);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, EveryLidar,
                         testing::Values("vlp16", "hdl32e", "hdl64e", "os1_64", "os1_128",
                                         "pandar40p", "livox"),
                         [](const auto& test) { return test.param; });

class HeldBoards : public EveryLidar {};

TEST_P(HeldBoards, OnAStand) {
  for (int i = 0; i < 6; ++i) {
    Random random(DeriveSeed(7, GetParam(), 0, static_cast<std::uint64_t>(i)));
    Scene scene = TwoBoardsInRoom({}, random);
    for (int b = 0; b < 2; ++b)
      AddStand(SceneBoard(scene.boards[static_cast<std::size_t>(b)]), scene);
    ExpectBoth(scene, i, 0.03);
  }
}

TEST_P(HeldBoards, InHands) {
  for (int i = 0; i < 6; ++i) {
    Random random(DeriveSeed(8, GetParam(), 0, static_cast<std::uint64_t>(i)));
    Scene scene = TwoBoardsInRoom({}, random);
    for (int b = 0; b < 2; ++b) {
      AddHolder(SceneBoard(scene.boards[static_cast<std::size_t>(b)]), random, scene);
    }
    ExpectBoth(scene, i, 0.03);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, HeldBoards, testing::Values("vlp16", "os1_64"),
                         [](const auto& test) { return test.param; });

// Rings cross all four sides of a board that is rotated by 20 degrees or more.
TEST(BoardsInScans, OtherAnglesThan45WhereTheRingsAllowIt) {
  const LidarModel model = ModelWithSigma("os1_64", 0.01);
  for (const double turn : {20.0, 30.0, 60.0, 70.0}) {
    Random random(9);
    Scene scene = TwoBoardsInRoom({}, random);
    scene.boards = {PlaceBoard(scene.boards[0].board, {.azimuth_deg = 10.0, .turn_deg = turn})};
    const std::vector<Board> boards = BoardsIn(scene);
    const BoardSearch search = SearchScan(scene, boards, model, 1);
    ASSERT_EQ(search.found.size(), 1U) << turn;
    for (const double off : WorstCorners(scene, search)) EXPECT_LT(off, 0.01) << turn;
    EXPECT_TRUE(ExtractCorners("plane_lines", search.found[0], boards[0])) << turn;
  }
}

// Users of RectangleFit::on_edge expect edge points on the board's true outline.
TEST(BoardsInScans, EdgePointsLieOnTheOutlineWithoutTheGrowthByTheBeam) {
  const LidarModel model = ModelWithSigma("os1_64", 0.01);
  std::vector<double> beyond;
  for (int i = 0; i < 4; ++i) {
    Random random(DeriveSeed(10, "outline", 0, static_cast<std::uint64_t>(i)));
    const Scene scene = TwoBoardsInRoom({}, random);
    const std::vector<Board> boards = BoardsIn(scene);
    const BoardSearch search = SearchScan(scene, boards, model, static_cast<std::uint64_t>(i));
    ASSERT_EQ(search.found.size(), 2U) << i;
    for (const BoardPatch& patch : search.found) {
      const Board& board = boards[static_cast<std::size_t>(patch.board)];
      for (std::size_t k = 0; k < patch.edges.size(); ++k) {
        if (patch.fit.sides[k] < 0) continue;
        beyond.push_back(BeyondBoard(patch.fit, board, patch.fit.on_edge[k]));
      }
    }
  }
  ASSERT_GT(beyond.size(), 100U);
  EXPECT_NEAR(Mean(beyond), 0.0, 0.002);
}

// Upright, no ring crosses its upper and lower sides.
TEST(BoardsInScans, SidesAlongTheRingsAreRefusedWithTheirNumbers) {
  const LidarModel model = ModelWithSigma("os1_64", 0.01);
  Random random(10);
  Scene scene = TwoBoardsInRoom({}, random);
  scene.boards = {PlaceBoard(scene.boards[0].board, {.azimuth_deg = 10.0, .turn_deg = 0.0})};
  const std::vector<Board> boards = BoardsIn(scene);
  const BoardSearch search = SearchScan(scene, boards, model, 1);
  ASSERT_EQ(search.found.size(), 1U);
  const Expected<LidarCorners> corners = ExtractCorners("plane_lines", search.found[0], boards[0]);
  ASSERT_FALSE(corners);
  EXPECT_EQ(corners.error().code, ErrorCode::kTooFewPairs);
  EXPECT_NE(corners.error().message.find("0 rings cross"), std::string::npos)
      << corners.error().message;
  EXPECT_NE(corners.error().message.find("2 are needed"), std::string::npos);
}

TEST(BoardsInScans, NoBoardWhereThereIsNone) {
  const LidarModel model = *FindLidarModel("vlp16");
  Board board;
  board.top_right_m = 0.484;
  board.right_bottom_m = 0.468;
  for (int i = 0; i < 60; ++i) {
    Random random(DeriveSeed(3, "no board", 0, static_cast<std::uint64_t>(i)));
    const BoardSearch search =
        SearchScan(FurnishedRoom(random), {board}, model, static_cast<std::uint64_t>(i));
    EXPECT_TRUE(search.found.empty()) << "scan " << i;
  }
}

TEST(BoardsInScans, HollowBoardGivesEightCorners) {
  const LidarModel model = ModelWithSigma("hdl64e", 0.01);
  Board board;
  board.top_right_m = 1.0;
  board.right_bottom_m = 1.0;
  board.hole = BoardHole{.width_m = 0.6, .height_m = 0.6};
  Random random(4);
  Scene scene = TwoBoardsInRoom({.distance_m = 2.0}, random);
  scene.boards = {PlaceBoard(board, {.azimuth_deg = 5.0, .distance_m = 2.2})};
  const BoardSearch search = SearchScan(scene, {board}, model, 1);
  ASSERT_EQ(search.found.size(), 1U);
  // 3D lines include the range noise; see the test of the extractors' errors.
  const std::map<std::string, double> allowed = {
      {"rectangle", 0.02}, {"plane_lines", 0.03}, {"lines3d", 0.15}};
  for (const auto& [extractor, distance] : allowed) {
    const Expected<LidarCorners> corners = ExtractCorners(extractor, search.found[0], board);
    ASSERT_TRUE(corners) << extractor << ": " << corners.error().message;
    ASSERT_EQ(corners->in_lidar.size(), 8U);
    EXPECT_EQ(corners->covariance.rows(), 24);
    const Eigen::Vector3d inner_top =
        scene.boards[0].world_from_board * Eigen::Vector3d(-0.3, -0.3, 0.0);
    EXPECT_LT((corners->in_lidar[4] - inner_top).norm(), distance) << extractor;
  }
}

TEST(BoardsInScans, TooFewRingsAreReported) {
  const LidarModel model = *FindLidarModel("vlp16");
  Board board;
  board.top_right_m = 0.484;
  board.right_bottom_m = 0.468;
  Random random(5);
  Scene scene = TwoBoardsInRoom({.distance_m = 2.0}, random);
  scene.walls.clear();
  scene.boards = {PlaceBoard(board, {.distance_m = 5.5})};
  const BoardSearch search = SearchScan(scene, {board}, model, 1);
  EXPECT_TRUE(search.found.empty());
  ASSERT_FALSE(search.rejected.empty());
  EXPECT_NE(search.rejected[0].why.find("rings"), std::string::npos) << search.rejected[0].why;
}

TEST(BoardsInScans, WithoutARingFieldTheResultIsTheSame) {
  const LidarModel model = *FindLidarModel("vlp16");
  Random random(6);
  const Scene scene = TwoBoardsInRoom({.distance_m = 1.8}, random);
  const std::vector<Board> boards = BoardsIn(scene);
  Expected<SimulatedScan> scan = SimulateScan(scene, model, {.seed = 1});
  ASSERT_TRUE(scan);
  const BoardSearch with = *FindBoards(*ScanRings::Build(scan->cloud), boards, {});
  scan->cloud.ring.clear();
  const Expected<ScanRings> recovered = ScanRings::Build(scan->cloud);
  EXPECT_EQ(recovered->rings(), 16);
  const BoardSearch without = *FindBoards(*recovered, boards, {});
  ASSERT_EQ(with.found.size(), 2U);
  ASSERT_EQ(without.found.size(), 2U);
  EXPECT_LT((with.found[0].fit.center - without.found[0].fit.center).norm(), 1e-12);
}

TEST(BoardsInScans, UnknownExtractorNamesTheNearest) {
  const Expected<LidarCorners> corners = ExtractCorners("rectangel", {}, {});
  ASSERT_FALSE(corners);
  EXPECT_EQ(corners.error().code, ErrorCode::kUnknownName);
  EXPECT_NE(corners.error().message.find("'rectangle'"), std::string::npos);
}

}  // namespace
}  // namespace sextant::test
