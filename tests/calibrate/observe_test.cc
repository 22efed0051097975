// SPDX-License-Identifier: Apache-2.0
#include "calibrate/observe/observe.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/core.hpp>

#include "calibrate/match/matched_board.h"
#include "eval/extractors/board_scenes.h"
#include "geometry/symmetric.h"
#include "simulator/scene/camera_model.h"
#include "support/calibration_scene.h"

namespace sextant::test {
namespace {

Observer MakeObserver(const Scene& scene) {
  const Expected<Observer> observer = Observer::Make(BoardsIn(scene), *FindCameraModel("zed_left"));
  EXPECT_TRUE(observer) << observer.error().message;
  return *observer;
}

struct Seen {
  Scene scene;
  Observation observation;
};

Seen SeeAnew(std::uint64_t seed) {
  Random random(DeriveSeed(1, "observe", 0, seed));
  Seen seen{.scene = TaggedBoards(random), .observation = {}};
  const SensorData data = Record(seen.scene, seed);
  const Expected<Observation> observation =
      MakeObserver(seen.scene).Observe(data.image, data.cloud);
  EXPECT_TRUE(observation) << observation.error().message;
  seen.observation = *observation;
  return seen;
}

// Once per process.
const Seen& See(std::uint64_t seed) {
  static std::map<std::uint64_t, Seen> all;
  const auto known = all.find(seed);
  return known != all.end() ? known->second : all.emplace(seed, SeeAnew(seed)).first->second;
}

// The true patch and the true placement.
MatchedBoard TrueMatch(const Seen& seen, int board) {
  MatchedBoard match{.sighting = board};
  double nearest = 1e9;
  const Eigen::Vector3d corner = TrueCorner(seen.scene.boards[static_cast<std::size_t>(board)], 0);
  for (std::size_t p = 0; p < seen.observation.in_scan.size(); ++p) {
    const auto& placements = seen.observation.in_scan[p].placements;
    for (std::size_t k = 0; k < placements.size(); ++k) {
      const double off = (placements[k].corners.in_lidar[0] - corner).norm();
      if (placements[k].board != board || off > nearest) continue;
      nearest = off;
      match.patch = static_cast<int>(p);
      match.placement = static_cast<int>(k);
    }
  }
  EXPECT_LT(nearest, 0.02);
  return match;
}

TEST(Observe, BothBoardsInEveryWayThatTheirOutlineAllows) {
  const Seen& seen = See(10);
  ASSERT_EQ(seen.observation.in_image.size(), 2U);
  ASSERT_EQ(seen.observation.in_scan.size(), 2U);
  EXPECT_THAT(seen.observation.missing, testing::IsEmpty());
  for (const LidarSighting& patch : seen.observation.in_scan) {
    // 48.4 x 46.8 and 49.0 x 46.8 cm: each may be both boards, in four turns.
    EXPECT_EQ(patch.placements.size(), 8U);
    EXPECT_EQ(patch.placements.front().misfit, 0.0);
    // The LiDAR's own sigma, 3 cm / 3 as a VLP-16's data sheet means it, and its rings' biases.
    EXPECT_GT(patch.range_sigma_m, 0.002);
    EXPECT_LT(patch.range_sigma_m, 0.03);
  }
}

TEST(Observe, EveryPlacementPutsTheCornersWhereItsPoseDoes) {
  const Seen& seen = See(11);
  const std::vector<Board> boards = BoardsIn(seen.scene);
  for (const LidarSighting& patch : seen.observation.in_scan) {
    for (const BoardPlacement& placement : patch.placements) {
      const std::vector<Eigen::Vector3d> corners =
          BoardCorners(boards[static_cast<std::size_t>(placement.board)]);
      for (std::size_t i = 0; i < corners.size(); ++i) {
        EXPECT_LT((placement.lidar_from_board * corners[i] - placement.corners.in_lidar[i]).norm(),
                  1e-9);
      }
    }
  }
}

TEST(Observe, TurnsOfOnePatchAreQuarterTurns) {
  const Seen& seen = See(11);
  for (const LidarSighting& patch : seen.observation.in_scan) {
    for (const BoardPlacement& a : patch.placements) {
      for (const BoardPlacement& b : patch.placements) {
        if (a.board != b.board) continue;
        const double turned =
            RotationDistance(a.lidar_from_board.rotation, b.lidar_from_board.rotation);
        const int quarters = std::abs(a.turn - b.turn);
        // An outline that is 2 cm too wide for its place is fitted a little askew.
        EXPECT_NEAR(turned, 0.5 * M_PI * std::min(quarters, 4 - quarters), 0.1);
      }
    }
  }
}

// Rays to the sides, met with the true board, lie on the sides that they are said to be on.
TEST(Observe, RawObservationsAreTrueToTheirSigmas) {
  constexpr int kViews = 6;
  double squares = 0.0;
  int rays = 0;
  double face = 0.0;
  double returns = 0.0;
  for (std::uint64_t view = 0; view < kViews; ++view) {
    const Seen& seen = See(10 + view);
    for (int b = 0; b < 2; ++b) {
      const SceneBoard& truth = seen.scene.boards[static_cast<std::size_t>(b)];
      const BoardView raw =
          MakeBoardView(seen.observation, TrueMatch(seen, b), BoardsIn(seen.scene));
      EXPECT_EQ(raw.board, b);
      EXPECT_EQ(raw.printed.size(), 1U);
      const Rigid3d board_from_lidar = truth.world_from_board.Inverse();
      const Eigen::Vector3d eye = board_from_lidar.translation;
      const Eigen::Vector2d half(0.5 * truth.board.top_right_m, 0.5 * truth.board.right_bottom_m);
      for (const EdgeRay& ray : raw.edges) {
        const Eigen::Vector3d along = board_from_lidar.rotation * ray.direction;
        const Eigen::Vector3d there = eye - along * (eye.z() / along.z());
        const int axis = ray.side % 2 == 0 ? 1 : 0;
        const double side = ray.side == 1 || ray.side == 2 ? half(axis) : -half(axis);
        squares += std::pow((there(axis) - side) / ray.sigma_m, 2);
        ++rays;
      }
      for (const Eigen::Vector3d& point : raw.face_in_lidar) {
        const Eigen::Vector3d in_board = board_from_lidar * point;
        face += std::pow(in_board.z() / raw.range_sigma_m, 2);
        returns += 1.0;
      }
    }
  }
  EXPECT_GT(rays, 200);
  // The beam's spot and the rings' own biases are in neither sigma in full.
  EXPECT_LT(std::sqrt(squares / rays), 1.6);
  EXPECT_GT(std::sqrt(squares / rays), 0.6);
  EXPECT_LT(std::sqrt(face / returns), 1.6);
}

TEST(Observe, CornersOfAMatchAgreeUnderTheTruth) {
  const Seen& seen = See(12);
  CalibrationProblem problem;
  problem.camera = *FindCameraModel("zed_left");
  problem.boards = BoardsIn(seen.scene);
  const Rigid3d cam_from_lidar = TrueCamFromLidar(seen.scene);
  for (int b = 0; b < 2; ++b) {
    AppendPairs(seen.observation, TrueMatch(seen, b), problem.boards, cam_from_lidar, problem);
  }
  ASSERT_EQ(problem.pairs_3d3d.size(), 8U);
  ASSERT_EQ(problem.pairs_2d3d.size(), 8U);
  for (const Pair3d3d& pair : problem.pairs_3d3d) {
    const Eigen::Vector3d off = pair.point_in_cam - cam_from_lidar * pair.point_in_lidar;
    // Chi-square of 3 degrees of freedom: beyond 30 once in 700000.
    EXPECT_LT(SquaredMahalanobis(off, *pair.covariance_in_cam), 30.0);
  }
  for (const Pair2d3d& pair : problem.pairs_2d3d) {
    const auto pixel = Project(*problem.camera, cam_from_lidar * pair.point_in_lidar);
    ASSERT_TRUE(pixel);
    EXPECT_LT((*pixel - pair.pixel).norm(), 6.0 * pair.sigma_px);
  }
}

TEST(Observe, WhatIsMissingIsNamedWithItsReason) {
  Random random(3);
  Scene scene = TaggedBoards(random);
  const Observer observer = MakeObserver(scene);
  scene.boards.pop_back();
  const SensorData data = Record(scene, 3);
  const Observation observation = *observer.Observe(data.image, data.cloud);
  EXPECT_EQ(observation.in_image.size(), 1U);
  ASSERT_EQ(observation.missing.size(), 2U);
  EXPECT_TRUE(observation.missing[0].image);
  EXPECT_EQ(observation.missing[0].board, 1);
  EXPECT_EQ(observation.missing[0].why, "tag 582 of aruco_original was not found");
  EXPECT_FALSE(observation.missing[1].image);
  EXPECT_THAT(observation.missing[1].why, testing::HasSubstr("the scan shows 1 of 2 boards"));
}

// In aruco_original the mirror image of 582 is itself, and that of 26 is another tag, 656.
TEST(Observe, AMirroredPhotoIsRefusedWhereMirrorImagesAreTagsToo) {
  Random random(3);
  const Scene scene = TaggedBoards(random);
  const Observer observer = MakeObserver(scene);
  const SensorData data = Record(scene, 3);
  for (const int axis : {0, 1}) {
    cv::Mat mirrored;
    cv::flip(data.image, mirrored, axis);
    const Expected<Observation> observation = observer.Observe(mirrored, data.cloud);
    ASSERT_FALSE(observation);
    EXPECT_EQ(observation.error().code, ErrorCode::kMirrored);
    EXPECT_THAT(observation.error().message,
                testing::HasSubstr("tag 26 of aruco_original is found in its mirror image only"));
  }
}

TEST(Observe, ATagThatIsItsOwnMirrorImageIsNoReasonToRefuseAPhoto) {
  Random random(3);
  Scene scene = TaggedBoards(random);
  const Observer observer = MakeObserver(scene);
  scene.boards.erase(scene.boards.begin());
  const SensorData data = Record(scene, 3);
  const Expected<Observation> observation = observer.Observe(data.image, data.cloud);
  ASSERT_TRUE(observation) << observation.error().message;
  EXPECT_EQ(observation->in_image.size(), 1U);
}

TEST(Observe, UnknownExtractorAndBoardsWithoutSizeAreRefused) {
  Random random(4);
  std::vector<Board> boards = BoardsIn(TaggedBoards(random));
  const Camera camera = *FindCameraModel("zed_left");
  const Expected<Observer> unknown = Observer::Make(boards, camera, {.extractor = "rectangel"});
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::kUnknownName);
  boards[1].right_bottom_m = 0.0;
  const Expected<Observer> flat = Observer::Make(boards, camera);
  ASSERT_FALSE(flat);
  EXPECT_THAT(flat.error().message, testing::HasSubstr("board 1 has no size"));
  EXPECT_FALSE(Observer::Make({}, camera));
}

}  // namespace
}  // namespace sextant::test
