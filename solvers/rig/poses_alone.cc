// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "geometry/symmetric.h"
#include "solvers/kernels/kabsch.h"
#include "solvers/pnp/ippe.h"
#include "solvers/rig/rig_start.h"
#include "solvers/rig/rig_terms.h"

namespace sextant {
namespace {

struct BoardPairs {
  std::vector<Eigen::Vector3d> in_sensor;
  std::vector<Eigen::Vector3d> in_board;
};

BoardPlaneAlone Facing(const Eigen::Vector3d& normal, double distance_m) {
  if (distance_m < 0.0) return {-normal, -distance_m};
  return {normal, distance_m};
}

// Where two lines come nearest to each other; none where they are parallel to 5 degrees.
std::optional<Eigen::Vector3d> Meeting(const MeasuredLine& a, const MeasuredLine& b) {
  const double c = a.direction.dot(b.direction);
  const double rest = 1.0 - c * c;
  if (rest < 0.0076) return std::nullopt;
  const Eigen::Vector3d between = b.point - a.point;
  const double along_a = (between.dot(a.direction) - c * between.dot(b.direction)) / rest;
  const double along_b = (c * between.dot(a.direction) - between.dot(b.direction)) / rest;
  return 0.5 * (a.point + along_a * a.direction + b.point + along_b * b.direction);
}

// Corner i joins side i - 1 and side i; the same holds for the opening.
void AddMeetings(const std::vector<MeasuredLine>& lines, const Board& board, BoardPairs& pairs) {
  for (const MeasuredLine& line : lines) {
    for (const MeasuredLine& before : lines) {
      const bool same_outline = line.side / kCornersPerBoard == before.side / kCornersPerBoard;
      const int expected = (line.side + 3) % kCornersPerBoard;
      if (!same_outline || before.side % kCornersPerBoard != expected) continue;
      const auto meeting = Meeting(before, line);
      if (!meeting) continue;
      pairs.in_sensor.push_back(*meeting);
      const auto ends = EndsOf(board, line.side);
      const auto others = EndsOf(board, before.side);
      const bool first = (ends[0] - others[0]).norm() < 1e-9 || (ends[0] - others[1]).norm() < 1e-9;
      pairs.in_board.push_back(first ? ends[0] : ends[1]);
    }
  }
}

std::optional<Rigid3d> FromPairs(const RigObservation& seen, const Board& board) {
  BoardPairs pairs;
  for (const MeasuredPoint& point : seen.points) {
    pairs.in_sensor.push_back(point.in_sensor_m);
    pairs.in_board.push_back(point.in_board_m);
  }
  AddMeetings(seen.lines, board, pairs);
  if (seen.plane && !pairs.in_sensor.empty()) {
    const BoardPlaneAlone plane = Facing(seen.plane->normal, seen.plane->distance_m);
    for (std::size_t i = pairs.in_sensor.size(); i-- > 0;) {
      pairs.in_sensor.push_back(pairs.in_sensor[i] + plane.normal);
      pairs.in_board.push_back(pairs.in_board[i] + Eigen::Vector3d::UnitZ());
    }
  }
  if (pairs.in_sensor.size() < 3) return std::nullopt;
  const auto fit = FitKabsch(pairs.in_sensor, pairs.in_board);
  if (!fit) return std::nullopt;
  return fit->b_from_a;
}

// Both poses where the second explains the image nearly as well.
std::vector<Rigid3d> FromPrint(const RigObservation& seen, const Camera& camera) {
  constexpr double kSimilar = 9.0;
  std::vector<Eigen::Vector2d> image;
  std::vector<Eigen::Vector3d> in_board;
  for (const BoardPoints& printed : seen.raw.printed) {
    for (std::size_t k = 0; k < printed.pixels.size(); ++k) {
      const auto ray = Unproject(camera, printed.pixels[k]);
      if (!ray || !(ray->z() > 0.0)) continue;
      image.emplace_back(ray->x() / ray->z(), ray->y() / ray->z());
      in_board.emplace_back(printed.in_board_m[k].x(), printed.in_board_m[k].y(), 0.0);
    }
  }
  const auto fit = SolveIppe(image, in_board);
  if (!fit) return {};
  std::vector<Rigid3d> poses = {fit->cam_from_lidar[0]};
  if (fit->count > 1 && fit->sum_squares[1] < kSimilar * fit->sum_squares[0]) {
    poses.push_back(fit->cam_from_lidar[1]);
  }
  return poses;
}

std::optional<BoardPlaneAlone> FacePlane(const std::vector<Eigen::Vector3d>& face) {
  if (face.size() < 3) return std::nullopt;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : face) mean += point;
  mean /= static_cast<double>(face.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& point : face) {
    scatter += (point - mean) * (point - mean).transpose();
  }
  const SymmetricEigen<3> eigen = EigenOf<3>(scatter);
  if (!(eigen.values[1] > 1e-6 * eigen.values[2])) return std::nullopt;
  const Eigen::Vector3d normal = eigen.vectors.col(0);
  return Facing(normal, normal.dot(mean));
}

// The board's axes from the means of the edge points of opposite sides.
std::optional<Rigid3d> FromReturns(const RigObservation& seen) {
  const auto plane = FacePlane(seen.raw.face_in_lidar);
  if (!plane) return std::nullopt;
  std::array<Eigen::Vector3d, kCornersPerBoard> sums;
  sums.fill(Eigen::Vector3d::Zero());
  std::array<int, kCornersPerBoard> counts{};
  for (const EdgeRay& ray : seen.raw.edges) {
    const double along = plane->normal.dot(ray.direction);
    if (ray.side >= kCornersPerBoard || !(along > 1e-3)) continue;
    const auto side = static_cast<std::size_t>(ray.side);
    sums[side] += plane->distance_m / along * ray.direction;
    ++counts[side];
  }
  const auto mean = [&](std::size_t side) { return (sums[side] / counts[side]).eval(); };
  const bool has_x = counts[1] > 0 && counts[3] > 0;
  const bool has_y = counts[0] > 0 && counts[2] > 0;
  if (!has_x && !has_y) return std::nullopt;
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  if (has_x) x += (mean(1) - mean(3)).normalized();
  if (has_y) x += (mean(2) - mean(0)).normalized().cross(plane->normal);
  x = (x - x.dot(plane->normal) * plane->normal).normalized();
  Eigen::Matrix3d axes;
  axes << x, plane->normal.cross(x), plane->normal;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : seen.raw.face_in_lidar) middle += point;
  middle /= static_cast<double>(seen.raw.face_in_lidar.size());
  if (has_x && has_y) middle = 0.25 * (mean(0) + mean(1) + mean(2) + mean(3));
  return Rigid3d{Eigen::Quaterniond(axes), middle};
}

}  // namespace

std::vector<Rigid3d> PosesAlone(const RigObservation& seen, const RigSensor& sensor,
                                const Board& board) {
  if (seen.sensor_from_board) return {*seen.sensor_from_board};
  if (const auto pose = FromPairs(seen, board)) return {*pose};
  if (sensor.camera && !seen.raw.printed.empty()) return FromPrint(seen, *sensor.camera);
  if (const auto pose = FromReturns(seen)) return {*pose};
  return {};
}

std::optional<BoardPlaneAlone> PlaneAlone(const RigObservation& seen,
                                          const std::vector<Rigid3d>& poses) {
  if (seen.plane) return Facing(seen.plane->normal, seen.plane->distance_m);
  if (!poses.empty()) {
    const Eigen::Vector3d normal = poses[0].rotation * Eigen::Vector3d::UnitZ();
    return Facing(normal, normal.dot(poses[0].translation));
  }
  return FacePlane(seen.raw.face_in_lidar);
}

}  // namespace sextant
