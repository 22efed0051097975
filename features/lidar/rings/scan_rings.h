// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <span>
#include <vector>

#include "base/error.h"
#include "geometry/point_cloud.h"

namespace sextant {

/// A return in Cartesian and spherical coordinates.
struct RingPoint {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< In the LiDAR frame [m].
  double range_m = 0.0;
  double azimuth_rad = 0.0;  ///< About the scan's axis, in (-pi, pi].
  double sine = 0.0;         ///< The sine of the elevation above the plane normal to the axis.
  int index = 0;             ///< Index into the cloud.
};

/// A scan sorted by rings from the lowest up, each by ascending azimuth.
class ScanRings {
 public:
  /// Returns that are not finite or nearer than 1 cm are omitted. Rings come from the cloud's ring
  /// field or, without one or where it has one number for returns of many elevations, from the
  /// points themselves (features/lidar/rings/ring_numbers.h). If neither gives rings (a rosette,
  /// whatever its ring field contains), bands of elevation take their place, a few times as high as
  /// the spacing of the points. Errors: kMissingData if no return remains; kInvalidInput if the
  /// numbers of points and rings differ.
  static Expected<ScanRings> Build(const PointCloud& cloud);

  int rings() const { return static_cast<int>(starts_.size()) - 1; }
  std::span<const RingPoint> ring(int i) const {
    const auto k = static_cast<std::size_t>(i);
    return std::span(points_).subspan(starts_[k], starts_[k + 1] - starts_[k]);
  }
  std::span<const RingPoint> points() const { return points_; }
  /// Index of a ring's first point in points().
  std::size_t first(int ring) const { return starts_[static_cast<std::size_t>(ring)]; }

  /// The ring of an index into points().
  int RingOf(std::size_t place) const;

  /// The sensor's own number of a ring, or its place from the lowest up where the cloud has none;
  /// -1 for bands.
  int number(int ring) const { return has_rings_ ? numbers_[static_cast<std::size_t>(ring)] : -1; }

  /// Whether the sensor sweeps rings; if not, the rings are bands, whose points scatter in
  /// elevation.
  bool has_rings() const { return has_rings_; }

  /// The axis about which the sensor turns: z, unless the cloud was rotated. Rows of the rotation
  /// from the LiDAR frame to one with that axis as z, in which azimuths and elevations are stated.
  const Eigen::Matrix3d& level_from_lidar() const { return level_from_lidar_; }
  Eigen::Vector3d axis() const { return level_from_lidar_.row(2); }
  double AzimuthOf(const Eigen::Vector3d& point) const {
    return std::atan2(level_from_lidar_.row(1).dot(point), level_from_lidar_.row(0).dot(point));
  }

  /// Median angle between neighbours of a ring, and between neighbouring rings. For bands, the
  /// elevation step is their height, and the product of both steps is the solid angle per return.
  double azimuth_step_rad() const { return azimuth_step_rad_; }
  double elevation_step_rad() const { return elevation_step_rad_; }

  /// Range noise [m], from the deviation of returns from the mean of their two neighbours.
  double range_sigma_m() const { return range_sigma_m_; }

 private:
  void SortByRing(const std::vector<RingPoint>& points, const std::vector<int>& ring_of);
  void MeasureSteps();

  std::vector<RingPoint> points_;
  std::vector<std::size_t> starts_;
  std::vector<int> numbers_;
  Eigen::Matrix3d level_from_lidar_ = Eigen::Matrix3d::Identity();
  bool has_rings_ = true;
  double azimuth_step_rad_ = 0.0;
  double elevation_step_rad_ = 0.0;
  double range_sigma_m_ = 0.0;
};

}  // namespace sextant
