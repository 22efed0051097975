// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/board_view_residuals.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <limits>

namespace sextant {
namespace {

Eigen::MatrixXd WhitenerOf(const Eigen::MatrixXd& covariance) {
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  return factor.matrixL().solve(
      Eigen::MatrixXd::Identity(covariance.rows(), covariance.cols()).eval());
}

/// Intersection of a ray with the plane.
struct Intersection {
  double distance = 0.0;        // Along the ray.
  double inverse_slope = 0.0;   // 1 / n.d
  Eigen::Vector3d from_origin;  // From the origin of the board, in the plane.
};

bool Intersect(const Eigen::Vector3d& direction, const BoardPlane& plane, Intersection& out) {
  const auto normal = plane.axes.col(2);
  out.inverse_slope = 1.0 / normal.dot(direction);
  out.distance = normal.dot(plane.origin) * out.inverse_slope;
  out.from_origin = out.distance * direction - plane.origin;
  return out.distance > 0.0 && std::isfinite(out.distance);
}

// The intersection in the board's axes; the origin if there is none.
Eigen::Vector2d InBoard(const Eigen::Vector3d& direction, const BoardPlane& plane) {
  Intersection at;
  if (!Intersect(direction, plane, at)) return Eigen::Vector2d::Zero();
  return plane.axes.leftCols<2>().transpose() * at.from_origin;
}

const RoundHole& RimOf(const Board& board, int side) {
  return board.round_holes[static_cast<std::size_t>(side - kFirstRim)];
}

Eigen::Matrix<double, 1, 6> DistanceByPose(const Intersection& at, const BoardPlane& plane) {
  const Eigen::Vector3d normal = plane.axes.col(2);
  Eigen::Matrix<double, 1, 6> by_pose;
  by_pose << at.from_origin.cross(normal).transpose(), normal.transpose();
  return at.inverse_slope * by_pose;
}

}  // namespace

BoardSide SideOf(const Board& board, int side) {
  static const std::array<Eigen::Vector2d, 4> kOutward = {
      Eigen::Vector2d(0, -1), Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1), Eigen::Vector2d(-1, 0)};
  const Eigen::Vector2d outward = kOutward[static_cast<std::size_t>(side % kCornersPerBoard)];
  const Eigen::Vector2d half_share = 0.5 * outward.cwiseAbs();
  if (side < kCornersPerBoard) {
    const Eigen::Vector2d size(board.top_right_m, board.right_bottom_m);
    return {outward, half_share.dot(size), half_share};
  }
  const Eigen::Vector2d size(board.hole->width_m, board.hole->height_m);
  // The material is outside of the opening, so that the outward normal of its sides points inwards.
  return {-outward, -outward.dot(board.hole->center_in_board_m) - half_share.dot(size),
          Eigen::Vector2d::Zero()};
}

BoardSide TangentOf(const RoundHole& hole, const Eigen::Vector2d& in_board) {
  const Eigen::Vector2d arm = in_board - hole.center_in_board_m;
  const double length = arm.norm();
  const Eigen::Vector2d outward =
      length > 0.0 ? Eigen::Vector2d(-arm / length) : Eigen::Vector2d(Eigen::Vector2d::UnitX());
  return {outward, outward.dot(hole.center_in_board_m) - hole.radius_m, Eigen::Vector2d::Zero()};
}

BoardViewTerms TermsOf(const BoardView& view, const Board& board) {
  BoardViewTerms terms;
  const BoardPlane plane(view.lidar_from_board);
  for (const BoardPoints& points : view.printed) {
    terms.printed.push_back({points.in_board_m, points.pixels, WhitenerOf(points.covariance_px2)});
  }
  terms.face.reserve(view.face_in_lidar.size());
  for (const Eigen::Vector3d& point : view.face_in_lidar) {
    const double range = point.norm();
    terms.face.push_back({point / range, range, 1.0 / view.range_sigma_m});
  }
  terms.edges.reserve(view.edges.size());
  for (const EdgeRay& ray : view.edges) {
    const BoardSide side = ray.side < kFirstRim
                               ? SideOf(board, ray.side)
                               : TangentOf(RimOf(board, ray.side), InBoard(ray.direction, plane));
    terms.edges.push_back({ray.direction, side, 1.0 / ray.sigma_m});
  }
  return terms;
}

bool Differentiate(const PrintedTerm& term, const Camera& camera, const Rigid3d& cam_from_board,
                   PrintedResidual& out) {
  const auto count = static_cast<Eigen::Index>(term.pixels.size());
  out.value.resize(2 * count);
  out.by_pose.resize(2 * count, 6);
  out.in_cam.resize(term.pixels.size());
  const Eigen::Matrix3d rotation = cam_from_board.rotation.toRotationMatrix();
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Eigen::Vector3d arm = rotation.leftCols<2>() * term.in_board_m[k];
    out.in_cam[k] = arm + cam_from_board.translation;
    const auto projected = ProjectWithJacobian(camera, out.in_cam[k]);
    if (!projected) return false;
    out.value.segment<2>(2 * i) = term.pixels[k] - projected->pixel;
    out.by_pose.block<2, 3>(2 * i, 0) = projected->pixel_by_point * Hat(arm);
    out.by_pose.block<2, 3>(2 * i, 3) = -projected->pixel_by_point;
  }
  const auto whitener = term.whitener.triangularView<Eigen::Lower>();
  out.value = (whitener * out.value).eval();
  out.by_pose = (whitener * out.by_pose).eval();
  return out.value.allFinite();
}

bool Differentiate(const FaceTerm& term, const BoardPlane& plane, RayResidual& out) {
  Intersection at;
  if (!Intersect(term.direction, plane, at)) return false;
  out.value = term.inverse_sigma * (term.range_m - at.distance);
  out.by_pose = -term.inverse_sigma * DistanceByPose(at, plane);
  return true;
}

bool Differentiate(const EdgeTerm& term, const BoardPlane& plane, RayResidual& out) {
  Intersection at;
  if (!Intersect(term.direction, plane, at)) return false;
  // The outward axis a in the LiDAR frame: d(a.m) = (a x m).dphi + (a.d) ds - a.dt.
  const Eigen::Vector3d axis = plane.axes.leftCols<2>() * term.side.outward;
  out.value = term.inverse_sigma * (term.side.offset_m - axis.dot(at.from_origin));
  out.by_pose = axis.dot(term.direction) * DistanceByPose(at, plane);
  out.by_pose.head<3>() += axis.cross(at.from_origin).transpose();
  out.by_pose.tail<3>() -= axis.transpose();
  out.by_pose *= -term.inverse_sigma;
  return true;
}

BoardViewResiduals ResidualsOf(const BoardView& view, const Board& board, const Camera& camera,
                               const Rigid3d& cam_from_lidar, const Rigid3d& cam_from_board) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const BoardViewTerms terms = TermsOf(view, board);
  const BoardPlane plane(cam_from_lidar.Inverse() * cam_from_board);
  BoardViewResiduals residuals;
  PrintedResidual printed;
  for (const PrintedTerm& term : terms.printed) {
    const bool seen = Differentiate(term, camera, cam_from_board, printed);
    residuals.printed.push_back(
        seen ? printed.value.norm() / std::sqrt(static_cast<double>(printed.value.size())) : kNone);
  }
  RayResidual ray;
  for (const FaceTerm& term : terms.face) {
    residuals.face.push_back(Differentiate(term, plane, ray) ? ray.value : kNone);
  }
  for (const EdgeTerm& term : terms.edges) {
    residuals.edges.push_back(Differentiate(term, plane, ray) ? ray.value : kNone);
  }
  return residuals;
}

}  // namespace sextant
