// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/rotation_cost.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>

namespace sextant {
namespace {

using Vector9d = Eigen::Matrix<double, 9, 1>;

Vector9d Entries(const Eigen::Matrix3d& rotation) {
  Vector9d entries;
  entries << rotation.row(0).transpose(), rotation.row(1).transpose(), rotation.row(2).transpose();
  return entries;
}

}  // namespace

RotationCost::RotationCost(const Correspondences& data) {
  const ImageMoments& m = data.moments;
  const Eigen::Vector3d u0 = m.u.topRightCorner<1, 3>().transpose();
  const Eigen::Vector3d v0 = m.v.topRightCorner<1, 3>().transpose();
  const Eigen::Vector3d w0 = m.w.topRightCorner<1, 3>().transpose();
  // In camera coordinates x' = x - u_mean z, y' = y - v_mean z the image points are about their
  // mean, and the best centroid is x' = u0 . r3, y' = v0 . r3, z = depth . r.
  Vector9d depth;
  depth << u0, v0, -w0;
  depth /= m.Spread();
  const Eigen::Matrix3d squares = data.frame.deviation.cwiseAbs2().asDiagonal();
  omega_.setZero();
  omega_.block<3, 3>(0, 0) = squares;
  omega_.block<3, 3>(3, 3) = squares;
  omega_.block<3, 3>(0, 6) = -m.u.bottomRightCorner<3, 3>();
  omega_.block<3, 3>(3, 6) = -m.v.bottomRightCorner<3, 3>();
  omega_.block<3, 3>(6, 0) = omega_.block<3, 3>(0, 6);
  omega_.block<3, 3>(6, 3) = omega_.block<3, 3>(3, 6);
  omega_.block<3, 3>(6, 6) =
      m.w.bottomRightCorner<3, 3>() - u0 * u0.transpose() - v0 * v0.transpose();
  omega_ -= m.Spread() * depth * depth.transpose();

  // Transforms both sides back to camera coordinates.
  const Eigen::Vector2d mean = m.mean;
  omega_.rightCols<3>() -= mean.x() * omega_.leftCols<3>() + mean.y() * omega_.middleCols<3>(3);
  omega_.bottomRows<3>() -= mean.x() * omega_.topRows<3>() + mean.y() * omega_.middleRows<3>(3);
  Vector9d z = depth;
  z.tail<3>() -= mean.x() * depth.head<3>() + mean.y() * depth.segment<3>(3);
  centroid_by_rotation_.row(0) = mean.x() * z.transpose();
  centroid_by_rotation_.row(1) = mean.y() * z.transpose();
  centroid_by_rotation_.row(2) = z.transpose();
  centroid_by_rotation_.block<1, 3>(0, 6) += u0.transpose();
  centroid_by_rotation_.block<1, 3>(1, 6) += v0.transpose();
}

double RotationCost::operator()(const Eigen::Matrix3d& rotation) const {
  const Vector9d r = Entries(rotation);
  return std::max(0.0, r.dot(omega_ * r));
}

Eigen::Vector3d RotationCost::Centroid(const Eigen::Matrix3d& rotation) const {
  return centroid_by_rotation_ * Entries(rotation);
}

Eigen::Matrix3d RotationCost::Minimize(Eigen::Matrix3d rotation) const {
  constexpr int kMaxSteps = 15;
  constexpr double kSmallStep = 1e-8;
  for (int i = 0; i < kMaxSteps; ++i) {
    const Eigen::Vector3d r1 = rotation.row(0);
    const Eigen::Vector3d r2 = rotation.row(1);
    const Eigen::Vector3d r3 = rotation.row(2);
    // Derivative of the entries by a rotation vector omega: row k of Hat(omega) R.
    Eigen::Matrix<double, 9, 3> turn = Eigen::Matrix<double, 9, 3>::Zero();
    turn.block<3, 1>(0, 1) = r3;
    turn.block<3, 1>(0, 2) = -r2;
    turn.block<3, 1>(3, 0) = -r3;
    turn.block<3, 1>(3, 2) = r1;
    turn.block<3, 1>(6, 0) = r2;
    turn.block<3, 1>(6, 1) = -r1;
    const Vector9d slope = omega_ * Entries(rotation);
    const Eigen::Vector3d gradient = turn.transpose() * slope;
    const Eigen::Matrix<double, 9, 3> turned_slope = omega_.lazyProduct(turn);
    const Eigen::Matrix3d convex = turn.transpose().lazyProduct(turned_slope);
    // Second order of Exp(omega) R times the slope: the curvature of the constraints.
    const Eigen::Matrix3d product = rotation * Eigen::Map<const Eigen::Matrix3d>(slope.data());
    Eigen::Matrix3d hessian = convex + 0.5 * (product + product.transpose());
    hessian.diagonal().array() -= product.trace();
    Eigen::LLT<Eigen::Matrix3d> factor(hessian);
    if (factor.info() != Eigen::Success) factor.compute(convex);
    if (factor.info() != Eigen::Success) break;
    const Eigen::Vector3d step = -factor.solve(gradient);
    const Eigen::Quaterniond turned(1.0, 0.5 * step.x(), 0.5 * step.y(), 0.5 * step.z());
    rotation = turned.normalized() * rotation;
    if (step.squaredNorm() < kSmallStep * kSmallStep) break;
  }
  return rotation;
}

}  // namespace sextant
