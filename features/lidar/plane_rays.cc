// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/plane_rays.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "features/lidar/azimuth.h"

namespace sextant {
namespace {

class RayCollector {
 public:
  RayCollector(const ScanRings& scan, const LidarPlane& plane, const Eigen::Vector2d& center,
               double reach_m)
      : scan_(scan), plane_(plane), center_(center), reach_(reach_m) {
    near_ = 0.02 + 4.0 * plane.sigma_m;
    const Eigen::Vector3d middle = plane.At(center);
    toward_ = middle.normalized();
    const double angle = std::min(1.5, std::atan2(reach_m, middle.norm()) * 1.1);
    cosine_ = std::cos(angle);
    azimuth_ = scan.AzimuthOf(middle);
    const double level = std::sqrt(std::max(0.0, 1.0 - std::pow(scan.axis().dot(toward_), 2)));
    half_width_ = std::sin(angle) < level ? std::asin(std::sin(angle) / level) : std::numbers::pi;
  }

  void AddRing(int ring, std::vector<PlaneRay>& rays) const {
    AddBetween(ring, azimuth_ - half_width_, azimuth_ + half_width_, rays);
    // The window may reach across the seam behind the sensor.
    constexpr double kTurn = 2.0 * std::numbers::pi;
    if (half_width_ >= std::numbers::pi) return;
    if (azimuth_ - half_width_ < -std::numbers::pi) {
      AddBetween(ring, azimuth_ - half_width_ + kTurn, 4.0, rays);
    }
    if (azimuth_ + half_width_ > std::numbers::pi) {
      AddBetween(ring, -4.0, azimuth_ + half_width_ - kTurn, rays);
    }
  }

 private:
  void AddBetween(int ring, double from, double to, std::vector<PlaneRay>& rays) const {
    if (half_width_ >= std::numbers::pi) {
      from = -4.0;
      to = 4.0;
    }
    const std::span<const RingPoint> points = scan_.ring(ring);
    for (auto it = std::ranges::lower_bound(points, from, {}, &RingPoint::azimuth_rad);
         it != points.end() && it->azimuth_rad <= to; ++it) {
      if (it->point.dot(toward_) < cosine_ * it->range_m) continue;
      const std::optional<Eigen::Vector2d> at = plane_.Meet(it->point);
      if (!at || (*at - center_).squaredNorm() > reach_ * reach_) continue;
      const double off = plane_.normal.dot(it->point - plane_.origin);
      const RayEnd end = std::abs(off) <= near_ ? RayEnd::kOnPlane
                         : off > 0.0            ? RayEnd::kBehind
                                                : RayEnd::kInFront;
      rays.push_back({*at, ring, end});
    }
  }

  const ScanRings& scan_;
  const LidarPlane& plane_;
  Eigen::Vector2d center_;
  double reach_;
  double near_;
  Eigen::Vector3d toward_;
  double cosine_;
  double azimuth_;
  double half_width_;
};

}  // namespace

PlaneRays RaysAround(const ScanRings& scan, const LidarPlane& plane, const Eigen::Vector2d& center,
                     double reach_m) {
  PlaneRays found;
  const RayCollector collector(scan, plane, center, reach_m);
  for (int ring = 0; ring < scan.rings(); ++ring) collector.AddRing(ring, found.rays);
  const Eigen::Vector3d middle = plane.At(center);
  const Eigen::Vector3d side = scan.axis().cross(middle);
  if (side.norm() < 1e-6 * middle.norm()) return found;
  found.azimuth_step_m = scan.azimuth_step_rad() * middle.norm();
  const Eigen::Vector3d left = side.normalized();
  const Eigen::Vector3d up = middle.cross(left).normalized();
  const auto beside = plane.Meet(middle + 1e-3 * middle.norm() * left);
  const auto above = plane.Meet(middle + std::tan(scan.elevation_step_rad()) * middle.norm() * up);
  if (!beside || !above) return found;
  found.ring_direction = (*beside - center).normalized();
  found.to_next_ring = *above - center;
  return found;
}

}  // namespace sextant
