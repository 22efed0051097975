// SPDX-License-Identifier: Apache-2.0
#include "eval/synthetic/simulate_pairs.h"

#include <fmt/core.h>

#include <cmath>
#include <vector>

#include "base/random.h"
#include "base/units.h"
#include "eval/synthetic/typical_sensors.h"
#include "geometry/random_vectors.h"
#include "simulator/scene/corner_noise.h"

namespace sextant {
namespace {

std::vector<Board> PaperBoards() {
  return {{.id = 0, .top_right_m = 0.468, .right_bottom_m = 0.484},
          {.id = 1, .top_right_m = 0.468, .right_bottom_m = 0.490}};
}

// Corners in the camera frame: top, right, bottom, left as the camera sees the board.
std::vector<Eigen::Vector3d> PlaceBoardInRoom(const Board& board, int index, Random& random) {
  const double turn = random.Uniform(-25.0, 25.0) * kRadPerDeg;
  const double lean = random.Uniform(-15.0, 15.0) * kRadPerDeg;
  const double roll = 45.0 * kRadPerDeg + random.Uniform(-5.0, 5.0) * kRadPerDeg;
  const double side = index % 2 == 0 ? -1.0 : 1.0;
  Eigen::Vector3d centre;
  centre.x() = side * 0.5 + random.Uniform(-0.08, 0.08);
  centre.y() = random.Uniform(-0.15, 0.15);
  centre.z() = random.Uniform(1.7, 2.2);
  const Eigen::Quaterniond cam_from_board =
      FromEulerZyx({.yaw = 0.0, .pitch = turn, .roll = lean}) *
      Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ());
  const double a = 0.5 * board.top_right_m;
  const double b = 0.5 * board.right_bottom_m;
  // Before the roll, x runs along top-right and y along right-bottom; the roll of 45 degrees turns
  // the first corner to the top.
  const std::vector<Eigen::Vector3d> in_board = {{-a, -b, 0}, {a, -b, 0}, {a, b, 0}, {-a, b, 0}};
  std::vector<Eigen::Vector3d> in_cam;
  for (const Eigen::Vector3d& corner : in_board) in_cam.push_back(centre + cam_from_board * corner);
  return in_cam;
}

CornerNoise NoiseOf(const PairSimulation& simulation) {
  return {.lidar_sigma_m = simulation.lidar_sigma_m,
          .camera_lateral_sigma_m = simulation.camera_lateral_sigma_m,
          .camera_depth_sigma_m = simulation.camera_depth_sigma_m,
          .pixel_sigma_px = simulation.pixel_sigma_px};
}

void DisplaceOutliers(const PairSimulation& simulation, Random& random,
                      CalibrationProblem& problem) {
  std::vector<int> displaced(static_cast<std::size_t>(simulation.outliers));
  random.Sample(static_cast<int>(problem.pairs_3d3d.size()), displaced);
  for (const int i : displaced) {
    const Eigen::Vector3d shift = simulation.outlier_shift_m * NormalVector(random).normalized();
    const auto index = static_cast<std::size_t>(i);
    problem.pairs_3d3d[index].point_in_lidar += shift;
    problem.pairs_2d3d[index].point_in_lidar += shift;
  }
}

Expected<void> Check(const PairSimulation& simulation, std::size_t boards) {
  if (simulation.views < 1 || simulation.views > PairSimulation::kMaxViews) {
    return MakeError(
        ErrorCode::kInvalidOption,
        fmt::format("expected 1 to {} views, got {}", PairSimulation::kMaxViews, simulation.views));
  }
  const int corners = simulation.views * static_cast<int>(boards) * kCornersPerBoard;
  if (simulation.outliers < 0 || simulation.outliers > corners) {
    return MakeError(ErrorCode::kInvalidOption, fmt::format("expected 0 to {} outliers, got {}",
                                                            corners, simulation.outliers));
  }
  for (const double sigma :
       {simulation.lidar_sigma_m, simulation.camera_lateral_sigma_m,
        simulation.camera_depth_sigma_m, simulation.pixel_sigma_px, simulation.outlier_shift_m}) {
    if (!(sigma > 0.0) || !std::isfinite(sigma)) {
      return MakeError(ErrorCode::kInvalidOption,
                       fmt::format("expected positive noise and shift, got {}", sigma));
    }
  }
  return {};
}

}  // namespace

Expected<SimulatedSession> SimulatePairs(const PairSimulation& simulation) {
  const std::vector<Board> boards = PaperBoards();
  SEXTANT_RETURN_IF_ERROR(Check(simulation, boards.size()));
  SimulatedSession session;
  session.problem.boards = boards;
  session.problem.camera = ZedLikeCamera();
  Random pose_random(DeriveSeed(simulation.seed, "simulate pairs: extrinsic", 0, 0));
  session.true_cam_from_lidar = DrawExtrinsic(pose_random);
  for (int view = 0; view < simulation.views; ++view) {
    Random random(
        DeriveSeed(simulation.seed, "simulate pairs: view", static_cast<std::uint64_t>(view), 0));
    for (const Board& board : boards) {
      const std::vector<Eigen::Vector3d> in_cam = PlaceBoardInRoom(board, board.id, random);
      for (int corner = 0; corner < kCornersPerBoard; ++corner) {
        const Eigen::Vector3d& point = in_cam[static_cast<std::size_t>(corner)];
        AddMeasuredCorner(NoiseOf(simulation), {view, board.id, corner}, point,
                          session.true_cam_from_lidar.Inverse() * point,
                          *Project(*session.problem.camera, point), random, session.problem);
      }
    }
  }
  Random outlier_random(DeriveSeed(simulation.seed, "simulate pairs: outliers", 0, 0));
  DisplaceOutliers(simulation, outlier_random, session.problem);
  session.problem.point_sets = WithholdPairing(session.problem.pairs_3d3d);
  return session;
}

}  // namespace sextant
