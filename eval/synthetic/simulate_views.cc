// SPDX-License-Identifier: Apache-2.0
#include "eval/synthetic/simulate_views.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <optional>

#include "base/random.h"
#include "eval/synthetic/board_observations.h"
#include "eval/synthetic/fit_board_pose.h"
#include "eval/synthetic/typical_sensors.h"

namespace sextant {
namespace {

Eigen::Matrix<double, 3, 6> PointByPose(const Rigid3d& pose, const Eigen::Vector3d& point) {
  Eigen::Matrix<double, 3, 6> by_pose;
  by_pose << -Hat(pose.rotation * point), Eigen::Matrix3d::Identity();
  return by_pose;
}

// Adds the board's corners, computed from each sensor's pose of the board, with the covariance of
// their difference.
void AddCorners(const BoardPoseFit& in_cam, const BoardPoseFit& in_lidar, const Board& board,
                const Rigid3d& cam_from_lidar, const PairId& of, CalibrationProblem& problem) {
  const Eigen::Matrix3d turn = cam_from_lidar.rotation.toRotationMatrix();
  const double a = 0.5 * board.top_right_m;
  const double b = 0.5 * board.right_bottom_m;
  const std::array<Eigen::Vector3d, 4> corners = {
      Eigen::Vector3d(-a, -b, 0), Eigen::Vector3d(a, -b, 0), Eigen::Vector3d(a, b, 0),
      Eigen::Vector3d(-a, b, 0)};
  for (int i = 0; i < kCornersPerBoard; ++i) {
    const Eigen::Vector3d& corner = corners[static_cast<std::size_t>(i)];
    const auto by_cam = PointByPose(in_cam.sensor_from_board, corner);
    const auto by_lidar = (turn * PointByPose(in_lidar.sensor_from_board, corner)).eval();
    Pair3d3d pair;
    pair.point_in_cam = in_cam.sensor_from_board * corner;
    pair.point_in_lidar = in_lidar.sensor_from_board * corner;
    const Eigen::Matrix3d covariance = by_cam * in_cam.covariance * by_cam.transpose() +
                                       by_lidar * in_lidar.covariance * by_lidar.transpose();
    pair.covariance_in_cam = 0.5 * (covariance + covariance.transpose());
    pair.id = {of.view, of.board, i};
    problem.pairs_3d3d.push_back(pair);
    // The board corner in the image; its uncertainty follows from that of the pose.
    const auto seen = ProjectWithJacobian(*problem.camera, pair.point_in_cam);
    if (!seen) continue;
    const Eigen::Matrix2d of_pixel =
        seen->pixel_by_point * *pair.covariance_in_cam * seen->pixel_by_point.transpose();
    problem.pairs_2d3d.push_back(
        {seen->pixel, pair.point_in_lidar, std::sqrt(0.5 * of_pixel.trace()), pair.id});
  }
}

Expected<void> Check(const ViewSimulation& simulation) {
  if (simulation.views < 1) {
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("expected at least 1 view, got {}", simulation.views));
  }
  for (const double size :
       {simulation.board_side_m, simulation.tag_edge_m, simulation.nearest_m,
        simulation.azimuth_step_deg, simulation.ring_step_deg, simulation.range_sigma_m,
        simulation.edge_sigma_m, simulation.pixel_sigma_px, simulation.farthest_m}) {
    if (!(size > 0.0) || !std::isfinite(size)) {
      return MakeError(ErrorCode::kInvalidOption,
                       fmt::format("expected positive sizes, steps and noise, got {}", size));
    }
  }
  return {};
}

// Adds one view; returns false if a sensor does not see the board or cannot determine its pose.
bool TryView(const ViewSimulation& simulation, const UnitErrors& unit, int index, Random& random,
             SimulatedViews& session) {
  CalibrationProblem& problem = session.problem;
  const Board& board = problem.boards.front();
  const Rigid3d cam_from_board = DrawBoardPose(simulation, session.true_cam_from_lidar, random);
  const Rigid3d lidar_from_board = session.true_cam_from_lidar.Inverse() * cam_from_board;
  if (!IsInImage(*problem.camera, board, cam_from_board)) return false;
  BoardView view;
  view.view = index;
  view.board = board.id;
  view.range_sigma_m = simulation.range_sigma_m;
  AddTag(simulation, *problem.camera, board, cam_from_board, view, random);
  const Rigid3d seen_by_lidar = lidar_from_board * DrawViewShift(simulation, index);
  AddReturns(simulation, unit, board, seen_by_lidar, view, random);
  if (!HasAllSides(view)) return false;
  const BoardViewTerms terms = TermsOf(view, board);
  const auto in_cam = FitBoardInCamera(terms, *problem.camera, cam_from_board);
  const auto in_lidar = FitBoardInLidar(terms, lidar_from_board);
  if (!in_cam || !in_lidar) return false;
  view.cam_from_board = in_cam->sensor_from_board;
  view.lidar_from_board = in_lidar->sensor_from_board;
  AddCorners(*in_cam, *in_lidar, board, session.true_cam_from_lidar, {index, board.id, 0}, problem);
  problem.board_views.push_back(std::move(view));
  session.true_cam_from_board.push_back(cam_from_board);
  return true;
}

}  // namespace

Expected<SimulatedViews> SimulateViews(const ViewSimulation& simulation) {
  SEXTANT_RETURN_IF_ERROR(Check(simulation));
  SimulatedViews session;
  session.problem.boards = {BoardOf(simulation)};
  session.problem.camera = ZedLikeCamera();
  session.problem.lidar_errors = simulation.errors;
  Random pose_random(DeriveSeed(simulation.seed, "simulate views: extrinsic", 0, 0));
  session.true_cam_from_lidar = DrawExtrinsic(pose_random);
  const UnitErrors unit = DrawUnit(simulation);
  constexpr int kMaxAttempts = 1000;
  for (int view = 0; view < simulation.views; ++view) {
    Random random(
        DeriveSeed(simulation.seed, "simulate views: view", static_cast<std::uint64_t>(view), 0));
    int attempts = 0;
    while (!TryView(simulation, unit, view, random, session)) {
      if (++attempts < kMaxAttempts) continue;
      return MakeError(ErrorCode::kInvalidOption,
                       fmt::format("in {} attempts no board of {} m was in view of both sensors; "
                                   "try a larger or nearer one, or more rings",
                                   kMaxAttempts, simulation.board_side_m));
    }
  }
  session.problem.point_sets = WithholdPairing(session.problem.pairs_3d3d);
  return session;
}

}  // namespace sextant
