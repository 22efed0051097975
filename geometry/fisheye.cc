// SPDX-License-Identifier: Apache-2.0
#include "geometry/fisheye.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/positive_polynomial.h"

namespace sextant {
namespace {

Polynomial<5> AngleTerms(const Camera& camera) {
  const auto& k = camera.distortion;
  return {1.0, k[0], k[1], k[2], k[3]};
}

bool TermsGrowUpTo(const Polynomial<5>& p, double theta) {
  const Polynomial<5> slope = {1.0, 3.0 * p[1], 5.0 * p[2], 7.0 * p[3], 9.0 * p[4]};
  return IsPositiveUpTo(slope, theta * theta);
}

// Near the axis, where theta_d / r is 1 / z to rounding.
LensImage OnAxis(const Eigen::Vector3d& point) {
  LensImage image;
  image.point = point.head<2>() / point.z();
  image.by_point << 1.0 / point.z(), 0.0, -image.point.x() / point.z(), 0.0, 1.0 / point.z(),
      -image.point.y() / point.z();
  return image;
}

// The angle whose distorted value is `target`; bisection guards the Newton steps.
std::optional<double> UndistortAngle(const Camera& camera, double target) {
  constexpr int kMaxSteps = 100;
  double low = 0.0;
  double high = std::numbers::pi;
  double theta = std::min(target, 0.25 * std::numbers::pi);
  for (int step = 0; step < kMaxSteps; ++step) {
    const std::optional<DistortedAngle> image = DistortAngle(camera, theta);
    const double missing = image ? target - image->value : -target;
    const double newton = image ? theta + missing / image->slope : high;
    if (image && std::abs(newton - theta) <= 1e-15) return newton;
    (missing < 0.0 ? high : low) = theta;
    theta = newton > low && newton < high ? newton : 0.5 * (low + high);
  }
  return std::nullopt;
}

}  // namespace

std::optional<LensImage> ProjectFisheye(const Camera& camera, const Eigen::Vector3d& point_in_cam) {
  // Here the next terms of the series are under 1e-16.
  constexpr double kOnAxis = 1e-8;
  const double radius = point_in_cam.head<2>().norm();
  const double z = point_in_cam.z();
  if (z > 0.0 && radius < kOnAxis * z) return OnAxis(point_in_cam);
  const double theta = std::atan2(radius, z);
  // Straight back, up to rounding, and no direction at all.
  if (!(radius > 0.0 && theta < std::numbers::pi)) return std::nullopt;
  const std::optional<DistortedAngle> angle = DistortAngle(camera, theta);
  if (!angle) return std::nullopt;
  const Eigen::Vector2d outward = point_in_cam.head<2>() / radius;
  const double along = angle->slope / (radius * radius + z * z);
  const double across = angle->value / radius;
  LensImage image;
  image.point = angle->value * outward;
  const Eigen::Matrix2d by_xy =
      across * Eigen::Matrix2d::Identity() + (along * z - across) * outward * outward.transpose();
  image.by_point << by_xy, -along * radius * outward;
  return image;
}

std::optional<Eigen::Vector3d> RayOfFisheye(const Camera& camera, const Eigen::Vector2d& image) {
  const double radius = image.norm();
  if (radius == 0.0) return Eigen::Vector3d::UnitZ();
  const std::optional<double> theta = UndistortAngle(camera, radius);
  if (!theta) return std::nullopt;
  Eigen::Vector3d ray;
  ray << std::sin(*theta) / radius * image, std::cos(*theta);
  return ray;
}

std::optional<DistortedAngle> DistortAngle(const Camera& equidistant, double theta) {
  const Polynomial<5> terms = AngleTerms(equidistant);
  if (!TermsGrowUpTo(terms, theta)) return std::nullopt;
  const double squared = theta * theta;
  const double factor = Value(terms, squared);
  return DistortedAngle{theta * factor, factor + 2.0 * squared * Slope(terms, squared)};
}

bool AngleGrowsUpTo(const Camera& equidistant, double theta) {
  return TermsGrowUpTo(AngleTerms(equidistant), theta);
}

}  // namespace sextant
