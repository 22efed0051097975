// SPDX-License-Identifier: Apache-2.0
#include "eval/synthetic/simulate_views.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/random.h"
#include "base/units.h"
#include "eval/synthetic/fit_board_pose.h"
#include "eval/synthetic/typical_sensors.h"
#include "geometry/board_check.h"

namespace sextant {
namespace {

Board TheBoard(const ViewSimulation& simulation) {
  Board board{
      .id = 0, .top_right_m = simulation.board_side_m, .right_bottom_m = simulation.board_side_m};
  board.tags.push_back({.family = "tag36h11", .id = 0, .edge_m = simulation.tag_edge_m});
  return board;
}

// cam_from_board with the centre near the LiDAR's horizon, as the LiDAR has the narrower vertical
// field of view, and the front towards the camera.
Rigid3d DrawBoardPose(const ViewSimulation& simulation, const Rigid3d& cam_from_lidar,
                      Random& random) {
  const double left = random.Uniform(-25.0, 25.0) * kRadPerDeg;
  const double up = random.Uniform(-5.0, 5.0) * kRadPerDeg;
  const double range = random.Uniform(simulation.nearest_m, simulation.farthest_m);
  const double axis = random.Uniform(0.0, 2.0 * std::numbers::pi);
  const double tilt = random.Uniform(0.0, 45.0) * kRadPerDeg;
  const double roll = random.Uniform(30.0, 60.0) * kRadPerDeg;
  const Eigen::Vector3d centre_in_lidar =
      range * Eigen::Vector3d(1.0, std::tan(left), std::tan(up)).normalized();
  const Eigen::Vector3d tilted = tilt * Eigen::Vector3d(std::cos(axis), std::sin(axis), 0.0);
  return {(ExpSo3(tilted) * ExpSo3({0.0, 0.0, roll})).normalized(),
          cam_from_lidar * centre_in_lidar};
}

/// What one unit of the LiDAR adds to its measurements.
struct UnitErrors {
  std::vector<double> ring_offsets_m;                  ///< With the constant of all rings.
  Eigen::Vector2d growth_m = Eigen::Vector2d::Zero();  ///< Along and across the scan direction.
};

UnitErrors DrawUnit(const ViewSimulation& simulation) {
  Random random(DeriveSeed(simulation.seed, "simulate views: unit", 0, 0));
  const LidarErrorModel& errors = simulation.errors;
  UnitErrors unit;
  const double constant = errors.range_offset_sigma_m * random.Normal();
  for (double& growth : unit.growth_m) growth = errors.edge_growth_sigma_m * random.Normal();
  for (int ring = 0; ring < simulation.rings; ++ring) {
    unit.ring_offsets_m.push_back(constant + errors.ring_offset_sigma_m * random.Normal());
  }
  if (simulation.exact) {
    unit.growth_m.setZero();
    unit.ring_offsets_m.assign(unit.ring_offsets_m.size(), 0.0);
  }
  return unit;
}

// The shift of all returns of one view, as of their board.
Rigid3d DrawViewShift(const ViewSimulation& simulation, int view) {
  Random random(
      DeriveSeed(simulation.seed, "simulate views: shift", static_cast<std::uint64_t>(view), 0));
  const double sigma = simulation.exact ? 0.0 : simulation.errors.view_shift_sigma_m;
  Vector6d shift;
  for (double& along : shift) along = sigma * random.Normal();
  const double lever = 0.5 * simulation.board_side_m;
  return {ExpSo3(shift.head<3>() / lever), shift.tail<3>()};
}

/// Simulates the returns and edge rays of one board in a scan with rings.
class RingScan {
 public:
  RingScan(const ViewSimulation& simulation, const UnitErrors& unit, const Board& board,
           const Rigid3d& lidar_from_board)
      : simulation_(simulation),
        unit_(unit),
        half_(0.5 * board.top_right_m, 0.5 * board.right_bottom_m),
        lidar_from_board_(lidar_from_board),
        axes_(lidar_from_board.rotation.toRotationMatrix()) {}

  void AddTo(BoardView& view, Random& random) const {
    const Eigen::Vector3d centre = lidar_from_board_.translation;
    const double middle = std::atan2(centre.y(), centre.x());
    const double reach = std::asin(std::min(1.0, half_.norm() / centre.norm())) + kRadPerDeg;
    const double step = simulation_.azimuth_step_deg * kRadPerDeg;
    for (int ring = 0; ring < simulation_.rings; ++ring) {
      const double elevation =
          (ring - 0.5 * (simulation_.rings - 1)) * simulation_.ring_step_deg * kRadPerDeg;
      double before = middle - reach - step * random.Uniform();
      for (double azimuth = before + step; azimuth < middle + reach + step; azimuth += step) {
        if (IsOn(elevation, azimuth)) AddReturn(ring, elevation, azimuth, view, random);
        if (IsOn(elevation, azimuth) != IsOn(elevation, before)) {
          AddEdge(elevation, before, azimuth, view, random);
        }
        before = azimuth;
      }
    }
  }

 private:
  static Eigen::Vector3d Direction(double elevation, double azimuth) {
    return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
            std::sin(elevation)};
  }

  // Where a ring's beams cross the axis.
  Eigen::Vector3d OriginOf(double elevation) const {
    return {0.0, 0.0, -simulation_.beam_crossing_m * std::tan(elevation)};
  }

  double RangeOf(double elevation, const Eigen::Vector3d& direction) const {
    return axes_.col(2).dot(lidar_from_board_.translation - OriginOf(elevation)) /
           axes_.col(2).dot(direction);
  }

  Eigen::Vector2d InBoard(double elevation, double azimuth) const {
    const Eigen::Vector3d direction = Direction(elevation, azimuth);
    return (lidar_from_board_.Inverse() *
            (OriginOf(elevation) + RangeOf(elevation, direction) * direction))
        .head<2>();
  }

  bool IsOn(double elevation, double azimuth) const {
    const Eigen::Vector2d at = InBoard(elevation, azimuth).cwiseAbs();
    return at.x() < half_.x() && at.y() < half_.y();
  }

  void AddReturn(int ring, double elevation, double azimuth, BoardView& view,
                 Random& random) const {
    const Eigen::Vector3d direction = Direction(elevation, azimuth);
    const double error = random.Normal() * (simulation_.exact ? 0.0 : simulation_.range_sigma_m);
    const double offset = unit_.ring_offsets_m[static_cast<std::size_t>(ring)];
    view.face_in_lidar.push_back((RangeOf(elevation, direction) + offset + error) * direction);
    view.face_rings.push_back(ring);
  }

  // Adds the edge between two azimuths of which exactly one is on the board.
  void AddEdge(double elevation, double from, double to, BoardView& view, Random& random) const {
    constexpr int kHalvings = 50;
    const bool from_is_on = IsOn(elevation, from);
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (from + to);
      (IsOn(elevation, middle) == from_is_on ? from : to) = middle;
    }
    const Eigen::Vector2d at = InBoard(elevation, from);
    const Eigen::Vector2d share = at.cwiseQuotient(half_);
    const bool on_x = std::abs(share.x()) > std::abs(share.y());
    EdgeRay ray;
    ray.side = on_x ? (share.x() > 0.0 ? 1 : 3) : (share.y() > 0.0 ? 2 : 0);
    ray.sigma_m = simulation_.edge_sigma_m;
    const double uniform = random.Uniform(-1.0, 1.0);
    const double error = simulation_.exact ? 0.0 : std::sqrt(3.0) * ray.sigma_m * uniform;
    Eigen::Vector3d seen(at.x(), at.y(), 0.0);
    const double outward = share[on_x ? 0 : 1] > 0.0 ? 1.0 : -1.0;
    seen[on_x ? 0 : 1] += error + outward * GrowthOf(elevation, from, on_x);
    ray.direction = (lidar_from_board_ * seen - OriginOf(elevation)).normalized();
    view.edges.push_back(ray);
  }

  // The distance by which a side normal to the board's x or y axis appears too far out.
  double GrowthOf(double elevation, double azimuth, bool on_x) const {
    const Eigen::Vector3d direction = Direction(elevation, azimuth);
    const Eigen::Vector3d along = Eigen::Vector3d::UnitZ().cross(direction).normalized();
    const Eigen::Vector3d normal = axes_.col(on_x ? 0 : 1);
    return unit_.growth_m[0] * std::abs(normal.dot(along)) +
           unit_.growth_m[1] * std::abs(normal.dot(direction.cross(along)));
  }

  const ViewSimulation& simulation_;
  const UnitErrors& unit_;
  Eigen::Vector2d half_;
  Rigid3d lidar_from_board_;
  Eigen::Matrix3d axes_;
};

bool IsInImage(const Camera& camera, const Board& board, const Rigid3d& cam_from_board) {
  for (const Eigen::Vector2d& corner : TagCorners(board.tags.front())) {
    const auto pixel = Project(camera, cam_from_board * Eigen::Vector3d(corner.x(), corner.y(), 0));
    if (!pixel || !(pixel->array() > 0.0).all() || !(pixel->x() < camera.width_px - 1) ||
        !(pixel->y() < camera.height_px - 1)) {
      return false;
    }
  }
  return true;
}

// Two rays on each side fix the rectangle in its plane.
bool HasAllSides(const BoardView& view) {
  constexpr int kMinRays = 2;
  std::array<int, kCornersPerBoard> count{};
  for (const EdgeRay& ray : view.edges) ++count[static_cast<std::size_t>(ray.side)];
  return *std::min_element(count.begin(), count.end()) >= kMinRays;
}

void AddTag(const ViewSimulation& simulation, const Camera& camera, const Board& board,
            const Rigid3d& cam_from_board, BoardView& view, Random& random) {
  const double sigma = simulation.pixel_sigma_px;
  BoardPoints points;
  for (const Eigen::Vector2d& corner : TagCorners(board.tags.front())) {
    Eigen::Vector2d pixel =
        *Project(camera, cam_from_board * Eigen::Vector3d(corner.x(), corner.y(), 0));
    for (int axis = 0; axis < 2; ++axis) {
      const double error = random.Normal() * sigma;
      if (!simulation.exact) pixel[axis] += error;
    }
    points.in_board_m.push_back(corner);
    points.pixels.push_back(pixel);
  }
  points.covariance_px2 = sigma * sigma * Eigen::MatrixXd::Identity(8, 8);
  view.printed.push_back(std::move(points));
}

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
  RingScan(simulation, unit, board, seen_by_lidar).AddTo(view, random);
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
  session.problem.boards = {TheBoard(simulation)};
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
