// SPDX-License-Identifier: Apache-2.0
#include "geometry/so3.h"

#include <cmath>

namespace sextant {
namespace {

// Below this angle the next term of each series is under 1e-17 relative.
constexpr double kSmallAngle = 1e-4;

}  // namespace

Eigen::Matrix3d Hat(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

Eigen::Quaterniond ExpSo3(const Eigen::Vector3d& phi) {
  const double angle = phi.norm();
  const double half = 0.5 * angle;
  const double scale = angle < kSmallAngle ? 0.5 - angle * angle / 48.0 : std::sin(half) / angle;
  Eigen::Quaterniond q;
  q.w() = std::cos(half);
  q.vec() = scale * phi;
  return q.normalized();
}

Eigen::Vector3d LogSo3(const Eigen::Quaterniond& rotation) {
  // q and -q are the same rotation; w >= 0 selects the angle of at most pi.
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  const double w = sign * rotation.w();
  const Eigen::Vector3d v = sign * rotation.vec();
  const double sine = v.norm();
  if (sine < kSmallAngle) return v * (2.0 / w) * (1.0 - sine * sine / (3.0 * w * w));
  return v * (2.0 * std::atan2(sine, w) / sine);
}

Eigen::Matrix3d LeftJacobianSo3(const Eigen::Vector3d& phi) {
  const double angle = phi.norm();
  const Eigen::Matrix3d hat = Hat(phi);
  const double a2 = angle * angle;
  const bool small = angle < kSmallAngle;
  const double first = small ? 0.5 - a2 / 24.0 : (1.0 - std::cos(angle)) / a2;
  const double second = small ? 1.0 / 6.0 - a2 / 120.0 : (angle - std::sin(angle)) / (a2 * angle);
  return Eigen::Matrix3d::Identity() + first * hat + second * hat * hat;
}

Eigen::Quaterniond RotationBetween(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d a = from.normalized();
  const Eigen::Vector3d sum = a + to.normalized();
  // Shorter sums are mostly rounding.
  constexpr double kOpposite = 1e-8;
  const double length = sum.norm();
  Eigen::Quaterniond rotation(0.0, 0.0, 0.0, 0.0);
  if (length > kOpposite) {
    // The bisector of the two is at half the angle, as is the quaternion.
    rotation.w() = a.dot(sum);
    rotation.vec() = a.cross(sum);
  } else {
    rotation.vec() = a.unitOrthogonal();
  }
  return rotation.normalized();
}

double RotationDistance(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return LogSo3(a * b.conjugate()).norm();
}

EulerZyx ToEulerZyx(const Eigen::Quaterniond& rotation) {
  const Eigen::Matrix3d r = rotation.toRotationMatrix();
  EulerZyx euler;
  const double cos_pitch = std::hypot(r(0, 0), r(1, 0));
  euler.pitch = std::atan2(-r(2, 0), cos_pitch);
  constexpr double kGimbalLock = 1e-9;
  if (cos_pitch < kGimbalLock) {
    euler.yaw = std::atan2(-r(0, 1), r(1, 1));
  } else {
    euler.yaw = std::atan2(r(1, 0), r(0, 0));
    euler.roll = std::atan2(r(2, 1), r(2, 2));
  }
  return euler;
}

Eigen::Quaterniond FromEulerZyx(const EulerZyx& euler) {
  return Eigen::AngleAxisd(euler.yaw, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(euler.pitch, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(euler.roll, Eigen::Vector3d::UnitX());
}

}  // namespace sextant
