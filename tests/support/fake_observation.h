// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "base/random.h"
#include "calibrate/observe/observe.h"
#include "features/camera/board_pose.h"
#include "geometry/scan_marks.h"
#include "geometry/so3.h"

namespace sextant::test {

inline constexpr double kFakeSigma_m = 0.005;

inline const Rigid3d kFakeCamFromLidar =
    Rigid3d{ExpSo3({0.05, -0.1, 0.08}), {0.06, -0.1, -0.15}} * AxesCamFromLidar();

/// A square board of 0.5 m with a tag.
inline Board SquareBoard(int id) {
  return {.id = id,
          .top_right_m = 0.5,
          .right_bottom_m = 0.5,
          .tags = {{.family = "aruco_original", .id = id, .edge_m = 0.2}}};
}

inline Eigen::Vector3d FakeNoise(Random& random, double sigma) {
  const double x = random.Normal();
  const double y = random.Normal();
  const double z = random.Normal();
  return sigma * Eigen::Vector3d(x, y, z);
}

// A pose with corner errors of about the sigma.
inline Rigid3d Disturbed(const Rigid3d& pose, double half_m, Random& random) {
  const Eigen::Vector3d turn = FakeNoise(random, kFakeSigma_m / half_m);
  return {ExpSo3(turn) * pose.rotation, pose.translation + FakeNoise(random, kFakeSigma_m)};
}

inline Eigen::MatrixXd CornerCovariance() {
  return 2.0 * kFakeSigma_m * kFakeSigma_m * Eigen::MatrixXd::Identity(12, 12);
}

inline std::vector<BoardPlacement> EveryPlacement(const Board& seen, std::span<const Board> boards,
                                                  const Rigid3d& lidar_from_board) {
  std::vector<BoardPlacement> placements;
  for (std::size_t b = 0; b < boards.size(); ++b) {
    for (int turn = 0; turn < 4; ++turn) {
      const Board turned = Turned(boards[b], turn);
      const double off = std::abs(turned.top_right_m - seen.top_right_m) +
                         std::abs(turned.right_bottom_m - seen.right_bottom_m);
      if (off > 0.12 * seen.top_right_m) continue;
      BoardPlacement placement{.board = static_cast<int>(b), .turn = turn};
      placement.lidar_from_board =
          lidar_from_board *
          Rigid3d{ExpSo3({0.0, 0.0, 0.5 * std::numbers::pi * turn}), Eigen::Vector3d::Zero()};
      for (const Eigen::Vector3d& corner : BoardCorners(boards[b])) {
        placement.corners.in_lidar.push_back(placement.lidar_from_board * corner);
      }
      placement.corners.covariance = CornerCovariance();
      placements.push_back(placement);
    }
  }
  return placements;
}

/// Random cam_from_board of a board about 2 m in front of the camera, with corner 0 up.
inline Rigid3d PlacedAtRandom(Random& random) {
  const Eigen::Vector3d lean = FakeNoise(random, 0.3);
  const double x = random.Uniform(-0.8, 0.8);
  const double y = random.Uniform(-0.3, 0.3);
  const double z = random.Uniform(1.6, 2.6);
  return {ExpSo3(lean) * ExpSo3({0.0, 0.0, 0.25 * std::numbers::pi}), {x, y, z}};
}

/// Observations of boards at these poses, without images and scans: corners with noise of
/// kFakeSigma_m per axis in both sensors, and patches that match every board whose outline fits
/// within an eighth, in every such rotation, last board first.
inline Observation FakeObservation(std::span<const Board> boards,
                                   std::span<const Rigid3d> cam_from_board,
                                   const Rigid3d& cam_from_lidar, Random& random) {
  Observation observation;
  for (std::size_t b = 0; b < boards.size(); ++b) {
    const double half = 0.5 * boards[b].top_right_m;
    CameraSighting sighting{.board = static_cast<int>(b)};
    sighting.pose.cam_from_board = Disturbed(cam_from_board[b], half, random);
    sighting.pose.covariance = kFakeSigma_m * kFakeSigma_m * Matrix6d::Identity();
    for (const Eigen::Vector3d& corner : BoardCorners(boards[b])) {
      sighting.corners.points.push_back(sighting.pose.cam_from_board * corner);
    }
    sighting.corners.covariance = CornerCovariance();
    observation.in_image.push_back(sighting);
  }
  for (std::size_t i = boards.size(); i-- > 0;) {
    const Rigid3d lidar_from_board = Disturbed(cam_from_lidar.Inverse() * cam_from_board[i],
                                               0.5 * boards[i].top_right_m, random);
    observation.in_scan.push_back(
        {.placements = EveryPlacement(boards[i], boards, lidar_from_board)});
  }
  return observation;
}

}  // namespace sextant::test
