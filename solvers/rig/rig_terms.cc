// SPDX-License-Identifier: Apache-2.0
#include "solvers/rig/rig_terms.h"

#include <Eigen/Geometry>
#include <utility>

namespace sextant {
namespace {

// The derivative of R p + t by (dphi, dt) is (-[R p]x, I).
Eigen::Matrix<double, 3, 6> PointByPose(const Eigen::Vector3d& turned) {
  Eigen::Matrix<double, 3, 6> by;
  by << -Hat(turned), Eigen::Matrix3d::Identity();
  return by;
}

template <class Term>
bool RayResidualsAt(const std::vector<Term>& terms, const Rigid3d& pose, RigResiduals& out) {
  const BoardPlane plane(pose);
  out.value.resize(std::ssize(terms));
  out.by_pose.resize(std::ssize(terms), 6);
  RayResidual ray;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (!Differentiate(terms[i], plane, ray)) return false;
    const auto row = static_cast<Eigen::Index>(i);
    out.value[row] = ray.value;
    out.by_pose.row(row) = ray.by_pose;
  }
  return true;
}

// A point of the board, and a direction along which its distance from the line counts.
struct AcrossLine {
  Eigen::Vector3d end;
  Eigen::Vector3d on_line;
  Eigen::Vector3d axis;
  double inverse_sigma = 0.0;
};

}  // namespace

std::array<Eigen::Vector3d, 2> EndsOf(const Board& board, int side) {
  const BoardSide line = SideOf(board, side);
  const Eigen::Vector2d along(-line.outward.y(), line.outward.x());
  const bool is_hole = side >= kCornersPerBoard;
  const Eigen::Vector2d center = is_hole ? board.hole->center_in_board_m : Eigen::Vector2d::Zero();
  const Eigen::Vector2d size = is_hole ? Eigen::Vector2d(board.hole->width_m, board.hole->height_m)
                                       : Eigen::Vector2d(board.top_right_m, board.right_bottom_m);
  const double half = 0.5 * along.cwiseAbs().dot(size);
  const Eigen::Vector2d middle = line.offset_m * line.outward + along * along.dot(center);
  const Eigen::Vector2d from = middle - half * along;
  const Eigen::Vector2d to = middle + half * along;
  return {Eigen::Vector3d(from.x(), from.y(), 0.0), Eigen::Vector3d(to.x(), to.y(), 0.0)};
}

RigResidualFunction PrintedResiduals(PrintedTerm term, std::shared_ptr<const Camera> camera) {
  return [term = std::make_shared<const PrintedTerm>(std::move(term)), camera = std::move(camera)](
             const Rigid3d& pose, RigResiduals& out) {
    PrintedResidual at;
    if (!Differentiate(*term, *camera, pose, at)) return false;
    out.value = at.value;
    out.by_pose = at.by_pose;
    return true;
  };
}

RigResidualFunction FaceResiduals(std::vector<FaceTerm> terms) {
  return [terms = std::make_shared<const std::vector<FaceTerm>>(std::move(terms))](
             const Rigid3d& pose, RigResiduals& out) { return RayResidualsAt(*terms, pose, out); };
}

RigResidualFunction EdgeResiduals(std::vector<EdgeTerm> terms) {
  return [terms = std::make_shared<const std::vector<EdgeTerm>>(std::move(terms))](
             const Rigid3d& pose, RigResiduals& out) { return RayResidualsAt(*terms, pose, out); };
}

RigResidualFunction PointResiduals(std::vector<MeasuredPoint> points) {
  return [points = std::make_shared<const std::vector<MeasuredPoint>>(std::move(points))](
             const Rigid3d& pose, RigResiduals& out) {
    out.value.resize(3 * std::ssize(*points));
    out.by_pose.resize(3 * std::ssize(*points), 6);
    Eigen::Index row = 0;
    for (const MeasuredPoint& point : *points) {
      const Eigen::Vector3d turned = pose.rotation * point.in_board_m;
      out.value.segment<3>(row) = (point.in_sensor_m - turned - pose.translation) / point.sigma_m;
      out.by_pose.middleRows<3>(row) = -PointByPose(turned) / point.sigma_m;
      row += 3;
    }
    return true;
  };
}

RigResidualFunction PlaneResiduals(const MeasuredPlane& plane) {
  return [plane](const Rigid3d& pose, RigResiduals& out) {
    const Eigen::Matrix3d axes = pose.rotation.toRotationMatrix();
    out.value.resize(3);
    out.by_pose.setZero(3, 6);
    for (int i = 0; i < 2; ++i) {
      out.value[i] = plane.normal.dot(axes.col(i)) / plane.sigma_rad;
      out.by_pose.block<1, 3>(i, 0) = axes.col(i).cross(plane.normal).transpose() / plane.sigma_rad;
    }
    out.value[2] = (plane.distance_m - plane.normal.dot(pose.translation)) / plane.sigma_m;
    out.by_pose.block<1, 3>(2, 3) = -plane.normal.transpose() / plane.sigma_m;
    return true;
  };
}

RigResidualFunction LineResiduals(const std::vector<MeasuredLine>& lines, const Board& board) {
  auto all = std::make_shared<std::vector<AcrossLine>>();
  for (const MeasuredLine& line : lines) {
    const Eigen::Vector3d first = line.direction.unitOrthogonal();
    const Eigen::Vector3d second = line.direction.cross(first);
    for (const Eigen::Vector3d& end : EndsOf(board, line.side)) {
      for (const Eigen::Vector3d& axis : {first, second}) {
        all->push_back({end, line.point, axis, 1.0 / line.sigma_m});
      }
    }
  }
  return [all = std::shared_ptr<const std::vector<AcrossLine>>(std::move(all))](const Rigid3d& pose,
                                                                                RigResiduals& out) {
    out.value.resize(std::ssize(*all));
    out.by_pose.resize(std::ssize(*all), 6);
    Eigen::Index row = 0;
    for (const AcrossLine& at : *all) {
      const Eigen::Vector3d turned = pose.rotation * at.end;
      out.value[row] = at.inverse_sigma * at.axis.dot(at.on_line - turned - pose.translation);
      out.by_pose.row(row) = -at.inverse_sigma * at.axis.transpose() * PointByPose(turned);
      ++row;
    }
    return true;
  };
}

}  // namespace sextant
