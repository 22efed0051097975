// SPDX-License-Identifier: Apache-2.0
#include "support/acfr_boards.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/symmetric.h"

namespace sextant::test {
namespace {

double Azimuth(const Eigen::Vector3d& point) { return std::atan2(point.y(), point.x()); }

}  // namespace

RingPoints FirstPass(const PointCloud& board) {
  // In order of time, clockwise: the azimuth decreases, except for one jump back where the end of
  // the scan overlaps its start.
  constexpr double kJump = 0.02;
  struct Pass {
    double first = 0.0;
    double last = 0.0;
    bool second = false;
  };
  std::map<int, Pass> passes;
  RingPoints rings;
  for (std::size_t i = 0; i < board.points.size(); ++i) {
    const int ring = board.ring[i];
    const double azimuth = Azimuth(board.points[i]);
    const auto [entry, is_first] = passes.try_emplace(ring, Pass{azimuth, azimuth, false});
    Pass& pass = entry->second;
    pass.second = pass.second || (!is_first && azimuth > pass.last + kJump);
    pass.last = azimuth;
    if (pass.second && azimuth < pass.first + 0.002) continue;
    rings[ring].push_back({board.points[i], azimuth});
  }
  for (auto& [ring, points] : rings) std::ranges::sort(points, {}, &BoardReturn::azimuth_rad);
  return rings;
}

Plane FitPlane(const RingPoints& board) {
  Plane plane;
  double limit = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < 8; ++iteration) {
    std::vector<Eigen::Vector3d> inliers;
    for (const auto& [ring, points] : board) {
      for (const BoardReturn& p : points) {
        const double off = plane.normal.dot(p.point - plane.center);
        if (std::abs(off) < limit) inliers.push_back(p.point);
      }
    }
    const auto count = static_cast<double>(inliers.size());
    plane.center.setZero();
    for (const Eigen::Vector3d& p : inliers) plane.center += p / count;
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& p : inliers) {
      scatter += (p - plane.center) * (p - plane.center).transpose() / count;
    }
    const SymmetricEigen<3> solved = EigenOf(scatter);
    plane.normal = solved.vectors.col(0);
    plane.rms_m = std::sqrt(solved.values[0]);
    limit = 0.05;
  }
  return plane;
}

Scene AcfrScene(const AcfrPose& pose) {
  auto corners = pose.in_lidar.corners_m;
  Eigen::Vector3d x = corners[1] - corners[0] + corners[2] - corners[3];
  Eigen::Vector3d y = corners[3] - corners[0] + corners[2] - corners[1];
  // z into the board, away from the LiDAR.
  if (x.cross(y).dot(corners[0]) < 0.0) std::swap(x, y);
  SceneBoard board;
  const bool wide = x.norm() > y.norm();
  board.board.top_right_m = wide ? 0.85 : 0.61;
  board.board.right_bottom_m = wide ? 0.61 : 0.85;
  board.board.checker =
      BoardChecker{.inner_columns = wide ? 7 : 5, .inner_rows = wide ? 5 : 7, .square_m = 0.095};
  const Eigen::Vector3d z = x.cross(y).normalized();
  // Distributes the deviation from a right angle equally between the two directions.
  const Eigen::Vector3d diagonal = (x.normalized() + y.normalized()).normalized();
  const Eigen::Vector3d across = z.cross(diagonal);
  Eigen::Matrix3d rotation;
  rotation << (diagonal - across).normalized(), (diagonal + across).normalized(), z;
  const Eigen::Vector3d center = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  board.world_from_board = {Eigen::Quaterniond(rotation), center};
  // As measured by the VLP-16 on this board: white mostly at intensities of 50 to 60, black at 0 to
  // 4.
  board.white.reflectivity = 0.6;
  board.black.reflectivity = 0.03;
  Scene scene;
  scene.name = "acfr";
  scene.boards = {board};
  for (int side = 0; side < 4; ++side) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.5 * M_PI * side, Eigen::Vector3d::UnitZ()));
    SceneWall wall;
    wall.name = "wall";
    // x to the right and y down when looking along the wall's z axis, here the rotated x axis of
    // the world.
    Eigen::Matrix3d forward;
    forward << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    wall.world_from_wall = {turn * Eigen::Quaterniond(forward), turn * Eigen::Vector3d(6, 0, 0)};
    wall.width_m = 12.0;
    wall.height_m = 6.0;
    scene.walls.push_back(wall);
  }
  return scene;
}

}  // namespace sextant::test
