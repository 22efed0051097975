// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/plane_frame.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "solvers/kernels/cloud_sums.h"
#include "solvers/pnp/point_cloud_frame.h"

namespace sextant {
namespace {

constexpr double kMaxFlatness = 0.1;

// The eigenvector of the smallest eigenvalue: the adjugate has the same eigenvectors, and each
// squaring squares the ratio of its largest eigenvalue to the others, which is 100 or more within
// kMaxFlatness.
Eigen::Vector3d LeastDirection(const Eigen::Matrix3d& symmetric) {
  Eigen::Matrix3d power;
  power.col(0) = symmetric.col(1).cross(symmetric.col(2));
  power.col(1) = symmetric.col(2).cross(symmetric.col(0));
  power.col(2) = symmetric.col(0).cross(symmetric.col(1));
  for (int squaring = 0; squaring < 3; ++squaring) {
    power /= power.trace();
    power = (power * power).eval();
  }
  Eigen::Index widest = 0;
  power.diagonal().maxCoeff(&widest);
  return power.col(widest).normalized();
}

}  // namespace

Expected<PlaneFrame> FramePlane(std::span<const Eigen::Vector3d> points) {
  PlaneFrame frame;
  frame.centroid = MeanOf(points);
  const Eigen::Matrix3d covariance = ScatterAbout(frame.centroid, points);
  const double variance = covariance.trace();
  if (!(std::sqrt(variance) + frame.centroid.norm() < kMaxDistance_m)) {
    return MakeError(
        ErrorCode::kDegenerate,
        fmt::format("the points are further than {:g} m away, where rounding destroys the "
                    "translation; give LiDAR points in metres",
                    kMaxDistance_m));
  }
  const Eigen::Vector3d normal = LeastDirection(covariance / variance);
  const Eigen::Vector3d across = normal.unitOrthogonal();
  const Eigen::Vector3d along = across.cross(normal);
  const double xx = along.dot(covariance * along);
  const double xy = along.dot(covariance * across);
  const double yy = across.dot(covariance * across);
  const double half_gap = std::hypot(0.5 * (xx - yy), xy);
  const double wide = 0.5 * (xx + yy) + half_gap;
  const double narrow = (xx * yy - xy * xy) / wide;
  if (!(narrow > kMinLineVariance * wide)) {
    return MakeError(ErrorCode::kDegenerate,
                     "the points coincide or lie on one line, which leaves a rotation "
                     "undetermined; use points that span a plane");
  }
  const double off = std::max(0.0, normal.dot(covariance * normal));
  frame.deviation = Eigen::Vector3d(wide, narrow, off).cwiseSqrt();
  const double flatness = frame.deviation.z() / frame.deviation.y();
  if (!(flatness < kMaxFlatness)) {
    return MakeError(ErrorCode::kDegenerate,
                     fmt::format("the points are {:.3g} m off their plane, {:.0f} percent of its "
                                 "smaller extent, expected under {:.0f}; use epnp or sqpnp",
                                 frame.deviation.z(), 100.0 * flatness, 100.0 * kMaxFlatness));
  }
  // Both (wide - yy, xy) and (xy, wide - xx) are along the widest axis; the longer has more digits.
  const Eigen::Vector2d widest =
      xx > yy ? Eigen::Vector2d(wide - yy, xy) : Eigen::Vector2d(xy, wide - xx);
  const bool is_round = !(widest.squaredNorm() > 0.0);
  const Eigen::Vector2d turn = is_round ? Eigen::Vector2d(1.0, 0.0) : widest.normalized();
  frame.axes.col(0) = turn.x() * along + turn.y() * across;
  frame.axes.col(2) = normal;
  frame.axes.col(1) = normal.cross(frame.axes.col(0));
  return frame;
}

void FlattenOntoPlane(std::span<Eigen::Vector3d> points) {
  const Expected<PlaneFrame> frame = FramePlane(points);
  if (!frame) return;
  const Eigen::Vector3d normal = frame->axes.col(2);
  for (Eigen::Vector3d& point : points) point -= normal.dot(point - frame->centroid) * normal;
}

}  // namespace sextant
