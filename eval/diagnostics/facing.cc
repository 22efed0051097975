// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/facing.h"

#include <algorithm>
#include <cmath>

#include "geometry/symmetric.h"

namespace sextant {
namespace {

// The side of the group's plane on which a sensor is: 1 or -1; 0 where that is not clear.
class GroupPlane {
 public:
  explicit GroupPlane(const std::vector<Eigen::Vector3d>& points) {
    for (const Eigen::Vector3d& point : points) middle_ += point;
    middle_ /= static_cast<double>(points.size());
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& point : points) {
      scatter += (point - middle_) * (point - middle_).transpose();
    }
    const SymmetricEigen<3> eigen = EigenOf<3>(scatter / static_cast<double>(points.size()));
    const Eigen::Vector3d extent = eigen.values.cwiseMax(0.0).cwiseSqrt();
    normal_ = eigen.vectors.col(0);
    constexpr double kMaxThickness = 0.15;
    is_plane_ = extent[1] > 0.0 && extent[0] < kMaxThickness * extent[1];
    width_ = extent[2];
    if (is_plane_) min_sine_ = std::max(kMinSine, kSigmas * extent[0] / extent[1]);
  }

  int SideOf(const Eigen::Vector3d& sensor) const {
    const double distance = normal_.dot(sensor - middle_);
    const double range = (sensor - middle_).norm();
    if (!is_plane_ || std::abs(distance) < kMinDistance * width_) return 0;
    if (std::abs(distance) < min_sine_ * range || range > kMaxRange * width_) return 0;
    return distance > 0.0 ? 1 : -1;
  }

 private:
  // Nobody measures a board that he sees at less than 10 degrees, and few points that lie near a
  // plane by chance are seen at more by both sensors, which are close to each other.
  static constexpr double kMinSine = 0.1736;
  // In sigmas of the normal, whose error comes from noise as large as the thickness.
  static constexpr double kSigmas = 3.0;
  // In widths of the group; a sensor that sees it is nearer, and a far origin is no sensor.
  static constexpr double kMinDistance = 0.1;
  static constexpr double kMaxRange = 1e4;

  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal_;
  bool is_plane_ = false;
  double width_ = 0.0;
  double min_sine_ = 1.0;
};

}  // namespace

bool SensorsFaceEachOther(std::span<const std::vector<Eigen::Vector3d>> groups_in_lidar,
                          const Rigid3d& cam_from_lidar) {
  const Eigen::Vector3d camera_in_lidar = cam_from_lidar.Inverse().translation;
  int between = 0;
  int beside = 0;
  for (const std::vector<Eigen::Vector3d>& points : groups_in_lidar) {
    if (points.size() < 3) continue;
    const GroupPlane plane(points);
    const int sides = plane.SideOf(Eigen::Vector3d::Zero()) * plane.SideOf(camera_in_lidar);
    if (sides < 0) ++between;
    if (sides > 0) ++beside;
  }
  return between > beside;
}

}  // namespace sextant
