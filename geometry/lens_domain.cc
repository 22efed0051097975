// SPDX-License-Identifier: Apache-2.0
#include "geometry/lens_domain.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/units.h"
#include "geometry/distortion.h"
#include "geometry/fisheye.h"

namespace sextant {
namespace {

constexpr double kPi = std::numbers::pi;

// The largest value up to `end` for which `holds`, which holds below it and not above.
template <class Holds>
double LastWhere(double end, const Holds& holds) {
  constexpr int kSteps = 60;
  if (holds(end)) return end;
  double low = 0.0;
  double high = end;
  for (int i = 0; i < kSteps; ++i) {
    const double middle = 0.5 * (low + high);
    (holds(middle) ? low : high) = middle;
  }
  return low;
}

// Radii of the distorted plane up to which a limit is looked for: 89.4 deg.
constexpr double kMaxRadius = 100.0;

double PlaneEnd(const Camera& camera) {
  return LastWhere(kMaxRadius, [&](double r) { return PlaneGrowsUpTo(camera, r); });
}

double PoleRadius(const Camera& camera) {
  return LastWhere(kMaxRadius, [&](double r) { return HasNoPoleUpTo(camera, r); });
}

// The angle from the axis of a radius of the plane that the omnidirectional model distorts.
double OmnidirectionalAngle(double xi, double radius) {
  const double under_root = 1.0 + (1.0 - xi * xi) * radius * radius;
  if (!(under_root > 0.0)) return std::acos(-1.0 / xi);
  const double onto_sphere = (xi + std::sqrt(under_root)) / (1.0 + radius * radius);
  return std::atan2(onto_sphere * radius, onto_sphere - xi);
}

std::string PlaneText(const Camera& camera) {
  const double end = PlaneEnd(camera);
  if (end >= kMaxRadius) return "the model has no limit but the plane of the camera";
  constexpr double kBeyond = 1.05;
  if (const double pole = PoleRadius(camera); pole < std::min(kBeyond * end, kMaxRadius)) {
    return fmt::format(
        "the rational distortion has a pole at r = {:.4g}, {:.1f} deg from the "
        "axis, where 1 + k4 r^2 + k5 r^4 + k6 r^6 is 0",
        pole, std::atan(pole) * kDegPerRad);
  }
  return fmt::format("the distortion folds the image at r = {:.4g}, {:.1f} deg from the axis", end,
                     DomainEnd(camera) * kDegPerRad);
}

}  // namespace

bool GrowsUpTo(const Camera& camera, double radius) {
  switch (camera.model) {
    case CameraModel::kPinhole:
    case CameraModel::kDoubleSphere:
      return true;
    case CameraModel::kBrownConrady:
    case CameraModel::kOmnidirectional:
      return PlaneGrowsUpTo(camera, radius);
    case CameraModel::kEquidistant:
      return AngleGrowsUpTo(camera, radius);
  }
  return false;
}

double DomainEnd(const Camera& camera) {
  switch (camera.model) {
    case CameraModel::kPinhole:
      return 0.5 * kPi;
    case CameraModel::kBrownConrady: {
      const double end = PlaneEnd(camera);
      return end < kMaxRadius ? std::atan(end) : 0.5 * kPi;
    }
    case CameraModel::kEquidistant:
      return LastWhere(kPi, [&](double theta) { return AngleGrowsUpTo(camera, theta); });
    case CameraModel::kOmnidirectional: {
      const double end = PlaneEnd(camera);
      const double of_sphere =
          camera.xi > 1.0 ? std::acos(-1.0 / camera.xi) : std::acos(-camera.xi);
      return end < kMaxRadius ? std::min(of_sphere, OmnidirectionalAngle(camera.xi, end))
                              : of_sphere;
    }
    case CameraModel::kDoubleSphere: {
      const double a = camera.alpha;
      const double w1 = a <= 0.5 ? a / (1.0 - a) : (1.0 - a) / a;
      const double w2 =
          (w1 + camera.xi) / std::sqrt(2.0 * w1 * camera.xi + camera.xi * camera.xi + 1.0);
      return std::acos(std::clamp(-w2, -1.0, 1.0));
    }
  }
  return 0.0;
}

std::string DomainText(const Camera& camera) {
  const bool of_plane =
      camera.model == CameraModel::kBrownConrady ||
      (camera.model == CameraModel::kOmnidirectional && PlaneEnd(camera) < kMaxRadius);
  if (of_plane) return PlaneText(camera);
  const char* what = camera.model == CameraModel::kEquidistant ? "the fisheye's polynomial grows"
                                                               : "the model projects";
  return fmt::format("{} up to {:.1f} deg from the axis", what, DomainEnd(camera) * kDegPerRad);
}

std::string WhyNotProjected(const Camera& camera, const Eigen::Vector3d& point_in_cam) {
  const bool is_flat =
      camera.model == CameraModel::kPinhole || camera.model == CameraModel::kBrownConrady;
  if (is_flat && !(point_in_cam.z() > 0.0)) {
    return fmt::format("it is behind the camera (z = {:.3g} m)", point_in_cam.z());
  }
  const double radius = point_in_cam.head<2>().norm();
  const double deg = std::atan2(radius, point_in_cam.z()) * kDegPerRad;
  if (!is_flat) {
    return fmt::format("it is {:.1f} deg from the axis, and {}", deg, DomainText(camera));
  }
  return fmt::format("it is at r = {:.4g}, {:.1f} deg from the axis, and {}",
                     radius / point_in_cam.z(), deg, DomainText(camera));
}

}  // namespace sextant
