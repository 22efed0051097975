// SPDX-License-Identifier: Apache-2.0
#include "eval/synthetic/board_observations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/units.h"
#include "geometry/board_check.h"

namespace sextant {
namespace {

/// Simulates the returns and edge rays of one board in a scan with rings.
class RingScan {
 public:
  RingScan(const ViewSimulation& simulation, const UnitErrors& unit, const Board& board,
           const Rigid3d& lidar_from_board)
      : simulation_(simulation),
        unit_(unit),
        half_(0.5 * board.top_right_m, 0.5 * board.right_bottom_m),
        lidar_from_board_(lidar_from_board),
        board_from_lidar_(lidar_from_board.Inverse()),
        axes_(lidar_from_board.rotation.toRotationMatrix()) {}

  void AddTo(BoardView& view, Random& random) const {
    const Eigen::Vector3d centre = lidar_from_board_.translation;
    const double middle = std::atan2(centre.y(), centre.x());
    const double reach = std::asin(std::min(1.0, half_.norm() / centre.norm())) + kRadPerDeg;
    const double step = simulation_.azimuth_step_deg * kRadPerDeg;
    for (int index = 0; index < simulation_.rings; ++index) {
      const Ring ring(simulation_, index);
      double before = middle - reach - step * random.Uniform();
      if (Misses(ring)) continue;
      bool was_on = IsOn(ring, before);
      double azimuth = before + step;
      while (azimuth < middle + reach + step) {
        const bool is_on = IsOn(ring, azimuth);
        if (is_on) AddReturn(ring, azimuth, view, random);
        if (is_on != was_on) AddEdge(ring, before, azimuth, view, random);
        before = azimuth;
        was_on = is_on;
        azimuth += step;
      }
    }
  }

 private:
  // The beams of one elevation.
  struct Ring {
    Ring(const ViewSimulation& simulation, int ring_index)
        : index(static_cast<std::size_t>(ring_index)),
          elevation((ring_index - 0.5 * (simulation.rings - 1)) * simulation.ring_step_deg *
                    kRadPerDeg),
          cosine(std::cos(elevation)),
          sine(std::sin(elevation)),
          origin(0.0, 0.0, -simulation.beam_crossing_m * std::tan(elevation)) {}

    Eigen::Vector3d Direction(double azimuth) const {
      return {cosine * std::cos(azimuth), cosine * std::sin(azimuth), sine};
    }

    std::size_t index;
    double elevation;
    double cosine;
    double sine;
    Eigen::Vector3d origin;  ///< Where the beams cross the axis.
  };

  // Whether no beam comes near enough to the board's centre: the angle between them is at least the
  // difference of their elevations.
  bool Misses(const Ring& ring) const {
    const Eigen::Vector3d to_centre = lidar_from_board_.translation - ring.origin;
    const double elevation = std::atan2(to_centre.z(), to_centre.head<2>().norm());
    const double radius = std::asin(std::min(1.0, half_.norm() / to_centre.norm()));
    return std::abs(ring.elevation - elevation) > radius + 1e-6;
  }

  double RangeOf(const Ring& ring, const Eigen::Vector3d& direction) const {
    return axes_.col(2).dot(lidar_from_board_.translation - ring.origin) /
           axes_.col(2).dot(direction);
  }

  Eigen::Vector2d InBoard(const Ring& ring, double azimuth) const {
    const Eigen::Vector3d direction = ring.Direction(azimuth);
    return (board_from_lidar_ * (ring.origin + RangeOf(ring, direction) * direction)).head<2>();
  }

  bool IsOn(const Ring& ring, double azimuth) const {
    const Eigen::Vector2d at = InBoard(ring, azimuth).cwiseAbs();
    return at.x() < half_.x() && at.y() < half_.y();
  }

  void AddReturn(const Ring& ring, double azimuth, BoardView& view, Random& random) const {
    const Eigen::Vector3d direction = ring.Direction(azimuth);
    const double error = random.Normal() * (simulation_.exact ? 0.0 : simulation_.range_sigma_m);
    const double offset = unit_.ring_offsets_m[ring.index];
    view.face_in_lidar.push_back((RangeOf(ring, direction) + offset + error) * direction);
    view.face_rings.push_back(static_cast<int>(ring.index));
  }

  // Adds the edge between two azimuths of which exactly one is on the board.
  void AddEdge(const Ring& ring, double from, double to, BoardView& view, Random& random) const {
    constexpr int kHalvings = 50;
    const bool from_is_on = IsOn(ring, from);
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (from + to);
      (IsOn(ring, middle) == from_is_on ? from : to) = middle;
    }
    const Eigen::Vector2d at = InBoard(ring, from);
    const Eigen::Vector2d share = at.cwiseQuotient(half_);
    const bool on_x = std::abs(share.x()) > std::abs(share.y());
    EdgeRay ray;
    ray.side = on_x ? (share.x() > 0.0 ? 1 : 3) : (share.y() > 0.0 ? 2 : 0);
    ray.sigma_m = simulation_.edge_sigma_m;
    const double uniform = random.Uniform(-1.0, 1.0);
    const double error = simulation_.exact ? 0.0 : std::sqrt(3.0) * ray.sigma_m * uniform;
    Eigen::Vector3d seen(at.x(), at.y(), 0.0);
    const double outward = share[on_x ? 0 : 1] > 0.0 ? 1.0 : -1.0;
    seen[on_x ? 0 : 1] += error + outward * GrowthOf(ring, from, on_x);
    ray.direction = (lidar_from_board_ * seen - ring.origin).normalized();
    view.edges.push_back(ray);
  }

  // The distance by which a side normal to the board's x or y axis appears too far out.
  double GrowthOf(const Ring& ring, double azimuth, bool on_x) const {
    const Eigen::Vector3d direction = ring.Direction(azimuth);
    const Eigen::Vector3d along = Eigen::Vector3d::UnitZ().cross(direction).normalized();
    const Eigen::Vector3d normal = axes_.col(on_x ? 0 : 1);
    return unit_.growth_m[0] * std::abs(normal.dot(along)) +
           unit_.growth_m[1] * std::abs(normal.dot(direction.cross(along)));
  }

  const ViewSimulation& simulation_;
  const UnitErrors& unit_;
  Eigen::Vector2d half_;
  Rigid3d lidar_from_board_;
  Rigid3d board_from_lidar_;
  Eigen::Matrix3d axes_;
};

}  // namespace

Board BoardOf(const ViewSimulation& simulation) {
  Board board{
      .id = 0, .top_right_m = simulation.board_side_m, .right_bottom_m = simulation.board_side_m};
  board.tags.push_back({.family = "tag36h11", .id = 0, .edge_m = simulation.tag_edge_m});
  return board;
}

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

Rigid3d DrawViewShift(const ViewSimulation& simulation, int view) {
  Random random(
      DeriveSeed(simulation.seed, "simulate views: shift", static_cast<std::uint64_t>(view), 0));
  const double sigma = simulation.exact ? 0.0 : simulation.errors.view_shift_sigma_m;
  Vector6d shift;
  for (double& along : shift) along = sigma * random.Normal();
  const double lever = 0.5 * simulation.board_side_m;
  return {ExpSo3(shift.head<3>() / lever), shift.tail<3>()};
}

void AddReturns(const ViewSimulation& simulation, const UnitErrors& unit, const Board& board,
                const Rigid3d& lidar_from_board, BoardView& view, Random& random) {
  RingScan(simulation, unit, board, lidar_from_board).AddTo(view, random);
}

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

}  // namespace sextant
