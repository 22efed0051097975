// SPDX-License-Identifier: Apache-2.0
// Boards with round holes: the holes place them, also where sides are missing.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "eval/extractors/board_scenes.h"
#include "features/lidar/corner_extractor.h"
#include "geometry/symmetric.h"
#include "io/boards/board_templates.h"
#include "io/clouds/cloud_file.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/lidar/scan.h"
#include "support/real_data.h"

namespace sextant::test {
namespace {

Scene RoomWithHoledBoard(const SceneBoard& board) {
  Random random(1);
  Scene scene = TwoBoardsInRoom({}, random);
  scene.boards = {board};
  return scene;
}

PointCloud ScanOf(const SceneBoard& board, const std::string& model_name, std::uint64_t seed) {
  LidarModel model = *FindLidarModel(model_name);
  model.range_sigma_m = 0.01;
  model.ring_bias_sigma_m = 0.0;
  return SimulateScan(RoomWithHoledBoard(board), model, {.seed = seed})->cloud;
}

BoardSearch SearchHoled(const PointCloud& cloud, const Board& board, const std::string& model) {
  BoardSearchOptions options;
  options.beam = *FindLidarBeam(model);
  return *FindBoards(*ScanRings::Build(cloud), std::vector<Board>{board}, options);
}

// The round holes' centres as placed in the scan, in the board's order, at one of the turns that
// look the same.
std::vector<Eigen::Vector3d> HoleCenters(const BoardPatch& patch, const Board& board, double turn) {
  std::vector<Eigen::Vector3d> centers;
  const Eigen::Rotation2Dd rotation(patch.fit.angle_rad + turn);
  for (const RoundHole& hole : board.round_holes) {
    centers.push_back(patch.plane.At(patch.fit.center + rotation * hole.center_in_board_m));
  }
  return centers;
}

double WorstHole(const BoardPatch& patch, const Board& board,
                 const std::vector<Eigen::Vector3d>& truth, bool either_way) {
  double best = std::numeric_limits<double>::infinity();
  for (const double turn : {0.0, std::acos(-1.0)}) {
    if (turn > 0.0 && !either_way) break;
    const std::vector<Eigen::Vector3d> centers = HoleCenters(patch, board, turn);
    double worst = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      worst = std::max(worst, (centers[i] - truth[i]).norm());
    }
    best = std::min(best, worst);
  }
  return best;
}

std::vector<Eigen::Vector3d> TrueHoles(const SceneBoard& placed) {
  std::vector<Eigen::Vector3d> centers;
  for (const RoundHole& hole : placed.board.round_holes) {
    const Eigen::Vector2d& p = hole.center_in_board_m;
    centers.push_back(placed.world_from_board * Eigen::Vector3d(p.x(), p.y(), 0.0));
  }
  return centers;
}

TEST(RoundHoles, PlaceABoardToMillimetresWithEverySensorThatSeesThem) {
  const Board board = *FindBoardTemplate("fast_calib");
  for (const std::string model : {"os1_128", "hdl64e", "livox"}) {
    for (const double turn : {0.0, 30.0, 90.0}) {
      const SceneBoard placed = PlaceBoard(
          board, {.distance_m = model == "livox" ? 4.0 : 2.6, .turn_deg = turn, .yaw_deg = 12.0});
      const BoardSearch search = SearchHoled(ScanOf(placed, model, 7), board, model);
      ASSERT_EQ(search.found.size(), 1U)
          << model << " " << turn
          << (search.rejected.empty() ? "" : ": " + search.rejected.front().why);
      EXPECT_LT(WorstHole(search.found[0], board, TrueHoles(placed), true), 0.012)
          << model << " " << turn;
      // The uppermost holes are above the highest ring of the HDL-64E.
      EXPECT_GE(search.found[0].fit.rims_seen, model == "hdl64e" ? 2 : 4) << model << " " << turn;
    }
  }
}

// As people crop clouds: without the background, two sides of the board, and half of a third.
TEST(RoundHoles, PlaceABoardWhoseSidesWereCropped) {
  const Board board = *FindBoardTemplate("fast_calib");
  double nees = 0.0;
  int boards = 0;
  for (int i = 0; i < 10; ++i) {
    const SceneBoard placed = PlaceBoard(
        board, {.distance_m = 4.0, .turn_deg = 4.0 * i - 18.0, .yaw_deg = 3.0 * i - 15.0});
    const PointCloud whole = ScanOf(placed, "livox", static_cast<std::uint64_t>(i));
    PointCloud cropped;
    const Rigid3d board_from_lidar = placed.world_from_board.Inverse();
    for (const Eigen::Vector3d& point : whole.points) {
      const Eigen::Vector3d p = board_from_lidar * point;
      if (std::abs(p.z()) < 0.1 && p.x() < 0.55 && p.y() < 0.42 && p.x() > -0.8 && p.y() > -0.6) {
        cropped.points.push_back(point);
      }
    }
    const BoardSearch search = SearchHoled(cropped, board, "livox");
    ASSERT_EQ(search.found.size(), 1U)
        << i << (search.rejected.empty() ? "" : ": " + search.rejected.front().why);
    // A single scan has returns 4 cm apart.
    EXPECT_LT(WorstHole(search.found[0], board, TrueHoles(placed), true), 0.02) << i;
    const auto corners = ExtractCorners("rectangle", search.found[0], board);
    ASSERT_TRUE(corners);
    for (int corner = 0; corner < kCornersPerBoard; ++corner) {
      double least = std::numeric_limits<double>::infinity();
      for (int k = 0; k < kCornersPerBoard; ++k) {
        const Eigen::Vector3d off =
            corners->in_lidar[static_cast<std::size_t>(corner)] - TrueCorner(placed, k);
        if (off.norm() < 0.1) least = SquaredMahalanobis(off, corners->CovarianceOf(corner)) / 3.0;
      }
      nees += least;
    }
    ++boards;
  }
  nees /= 4.0 * boards;
  EXPECT_GT(nees, 0.2);
  EXPECT_LT(nees, 2.0);
}

// Three holes in an L show which way up the board is.
TEST(RoundHoles, ThatAreNotSymmetricShowTheOrientation) {
  const Board board = *FindBoardTemplate("multisensor_calibration");
  for (const double turn : {10.0, 190.0, 100.0}) {
    const SceneBoard placed = PlaceBoard(board, {.distance_m = 2.2, .turn_deg = turn});
    const BoardSearch search = SearchHoled(ScanOf(placed, "os1_128", 3), board, "os1_128");
    ASSERT_EQ(search.found.size(), 1U)
        << turn << (search.rejected.empty() ? "" : ": " + search.rejected.front().why);
    EXPECT_LT(WorstHole(search.found[0], board, TrueHoles(placed), false), 0.012) << turn;
  }
}

TEST(RoundHoles, APlateWithoutThemIsNotTheBoard) {
  const Board holed = *FindBoardTemplate("fast_calib");
  const Board plain{.top_right_m = holed.top_right_m, .right_bottom_m = holed.right_bottom_m};
  for (const std::string model : {"vlp16", "os1_128", "livox"}) {
    const SceneBoard placed = PlaceBoard(plain, {.distance_m = 3.0, .turn_deg = 20.0});
    const BoardSearch search = SearchHoled(ScanOf(placed, model, 2), holed, model);
    EXPECT_TRUE(search.found.empty()) << model;
  }
}

TEST(RoundHoles, AreInNoRealScanWithoutSuchABoard) {
  SEXTANT_REAL_DATA(folder, "");
  for (const char* file :
       {"field/ouster64_garage/pointcloud9.pcd", "ouster64/lidar_data/pointcloud24.pcd"}) {
    const Expected<PointCloud> cloud = ReadCloud(folder / file);
    ASSERT_TRUE(cloud) << cloud.error().message;
    const ScanRings rings = *ScanRings::Build(*cloud);
    for (const char* name : {"fast_calib", "multisensor_calibration"}) {
      for (const double scale : {1.0, 0.6}) {
        Board board = *FindBoardTemplate(name);
        board.top_right_m *= scale;
        board.right_bottom_m *= scale;
        for (RoundHole& hole : board.round_holes) {
          hole.radius_m *= scale;
          hole.center_in_board_m *= scale;
        }
        const Expected<BoardSearch> search = FindBoards(rings, std::vector<Board>{board}, {});
        ASSERT_TRUE(search);
        EXPECT_TRUE(search->found.empty()) << file << " " << name << " " << scale;
      }
    }
  }
}

// A real accumulated scan of a Livox Mid-360, two sides of the board cropped. The centres are those
// of FAST-Calib, whose distances deviate from those of the board by up to 12 mm.
TEST(RoundHoles, OfARealCroppedScan) {
  SEXTANT_REAL_DATA(folder, "field/mid360_circles");
  const Expected<PointCloud> cloud = ReadCloud(folder / "filtered_cloud.ply");
  ASSERT_TRUE(cloud) << cloud.error().message;
  const Board board = *FindBoardTemplate("fast_calib");
  const Expected<BoardSearch> search =
      FindBoards(*ScanRings::Build(*cloud), std::vector<Board>{board}, {});
  ASSERT_TRUE(search);
  ASSERT_EQ(search->found.size(), 1U)
      << (search->rejected.empty() ? "" : search->rejected.front().why);
  const std::vector<Eigen::Vector3d> known = {{3.5745, .0710, .1187},
                                              {3.5539, -.4318, .1410},
                                              {3.5276, -.4502, -.2550},
                                              {3.5480, .0610, -.2750}};
  EXPECT_LT(WorstHole(search->found[0], board, known, true), 0.014);
  EXPECT_TRUE(search->others.empty());
}

}  // namespace
}  // namespace sextant::test
