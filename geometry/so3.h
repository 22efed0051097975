// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace sextant {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// The matrix [v]x with Hat(v) * w = v x w.
Eigen::Matrix3d Hat(const Eigen::Vector3d& v);

/// Rotation by |phi| radians about phi; exact to rounding at and near zero.
Eigen::Quaterniond ExpSo3(const Eigen::Vector3d& phi);

/// The shortest rotation vector [rad], |phi| <= pi. Inverse of ExpSo3 where |phi| < pi.
Eigen::Vector3d LogSo3(const Eigen::Quaterniond& rotation);

/// J with Exp(phi + d) = Exp(J d) Exp(phi) to first order in d.
Eigen::Matrix3d LeftJacobianSo3(const Eigen::Vector3d& phi);

/// The smallest rotation from one direction to another; where they are opposite to 1e-8 rad, half a
/// turn about any axis perpendicular to them. Neither may be zero.
Eigen::Quaterniond RotationBetween(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// Angle of b_from_a's rotation against another, in [0, pi] rad.
double RotationDistance(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b);

/// Yaw, pitch, roll in rad: R = Rz(yaw) Ry(pitch) Rx(roll), pitch in [-pi/2, pi/2].
struct EulerZyx {
  double yaw = 0.0;
  double pitch = 0.0;
  double roll = 0.0;
};

/// At pitch = +-pi/2 only yaw -+ roll is determined; roll is then set to zero.
EulerZyx ToEulerZyx(const Eigen::Quaterniond& rotation);
Eigen::Quaterniond FromEulerZyx(const EulerZyx& euler);

}  // namespace sextant
