// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/lidar_plane.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/symmetric.h"

namespace sextant {
namespace {

constexpr int kMinPointsOfPlane = 6;
constexpr std::size_t kMaxCounted = 300;  // Enough to decide which of two planes has more points.
constexpr double kMinSigma_m = 1e-6;      // For noise-free scans.
constexpr double kMinIncidence = 0.139;   // sin 8 deg; closer to edge-on, edges are meaningless.

struct HalfSpace {
  Eigen::Vector3d normal;
  double offset;
  double Distance(const Eigen::Vector3d& point) const { return normal.dot(point) - offset; }
};

std::optional<HalfSpace> ThroughThree(std::span<const Eigen::Vector3d> points,
                                      const std::array<int, 3>& sample) {
  const Eigen::Vector3d& a = points[static_cast<std::size_t>(sample[0])];
  const Eigen::Vector3d& b = points[static_cast<std::size_t>(sample[1])];
  const Eigen::Vector3d& c = points[static_cast<std::size_t>(sample[2])];
  const Eigen::Vector3d across = (b - a).cross(c - a);
  const double area = across.norm();
  if (area < 1e-3 * (b - a).norm() * (c - a).norm() + 1e-12) return std::nullopt;
  const Eigen::Vector3d normal = across / area;
  return HalfSpace{normal, normal.dot(a)};
}

std::vector<int> Within(std::span<const Eigen::Vector3d> points, const HalfSpace& plane,
                        double threshold) {
  std::vector<int> inliers;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::abs(plane.Distance(points[i])) <= threshold) inliers.push_back(static_cast<int>(i));
  }
  return inliers;
}

// Least-squares plane of the inliers, with the axes of a board's frame.
std::optional<LidarPlane> FitPlane(std::span<const Eigen::Vector3d> points,
                                   const std::vector<int>& inliers) {
  const auto count = static_cast<double>(inliers.size());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const int i : inliers) mean += points[static_cast<std::size_t>(i)];
  mean /= count;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const int i : inliers) {
    const Eigen::Vector3d d = points[static_cast<std::size_t>(i)] - mean;
    scatter += d * d.transpose();
  }
  const SymmetricEigen<3> eigen = EigenOf(scatter);
  if (eigen.values(1) < 1e-6 * eigen.values(2)) return std::nullopt;
  LidarPlane plane;
  plane.origin = mean;
  plane.normal = eigen.vectors.col(0);
  if (plane.normal.dot(mean) < 0.0) plane.normal = -plane.normal;
  if (plane.normal.dot(mean.normalized()) < kMinIncidence) return std::nullopt;
  // y points down as far as the plane allows; in a level plane, towards the sensor.
  const Eigen::Vector3d down = std::abs(plane.normal.z()) < 0.95
                                   ? Eigen::Vector3d(-Eigen::Vector3d::UnitZ())
                                   : Eigen::Vector3d(-mean);
  plane.x_axis = down.cross(plane.normal).normalized();
  plane.y_axis = plane.normal.cross(plane.x_axis);
  plane.sigma_m = std::max(kMinSigma_m, std::sqrt(std::max(0.0, eigen.values(0)) / (count - 3.0)));
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (const int i : inliers) {
    const Eigen::Vector3d d = points[static_cast<std::size_t>(i)] - mean;
    const Eigen::Vector3d row(1.0, plane.x_axis.dot(d), plane.y_axis.dot(d));
    information += row * row.transpose();
  }
  plane.covariance = plane.sigma_m * plane.sigma_m * information.inverse();
  return plane;
}

}  // namespace

std::optional<Eigen::Vector2d> LidarPlane::Meet(const Eigen::Vector3d& direction) const {
  const double along = normal.dot(direction);
  if (along < 1e-6 * direction.norm()) return std::nullopt;
  const Eigen::Vector3d point = direction * (normal.dot(origin) / along) - origin;
  return Eigen::Vector2d(x_axis.dot(point), y_axis.dot(point));
}

std::optional<FoundPlane> FindPlane(std::span<const Eigen::Vector3d> points,
                                    const PlaneSearch& search, Random& random) {
  const int count = static_cast<int>(points.size());
  if (count < kMinPointsOfPlane) return std::nullopt;
  std::optional<HalfSpace> best;
  std::size_t most = 0;
  std::array<int, 3> sample{};
  const std::size_t stride = 1 + points.size() / kMaxCounted;
  for (int i = 0; i < search.iterations; ++i) {
    random.Sample(count, sample);
    const std::optional<HalfSpace> plane = ThroughThree(points, sample);
    if (!plane) continue;
    std::size_t hits = 0;
    for (std::size_t k = 0; k < points.size(); k += stride) {
      hits += std::abs(plane->Distance(points[k])) <= search.threshold_m ? 1U : 0U;
    }
    if (hits > most) {
      most = hits;
      best = plane;
    }
  }
  if (!best || static_cast<double>(most * stride) < search.smallest_share * count)
    return std::nullopt;
  FoundPlane found;
  found.inliers = Within(points, *best, search.threshold_m);
  for (int round = 0; round < 4; ++round) {
    if (static_cast<int>(found.inliers.size()) < kMinPointsOfPlane) return std::nullopt;
    const std::optional<LidarPlane> plane = FitPlane(points, found.inliers);
    if (!plane) return std::nullopt;
    found.plane = *plane;
    const HalfSpace half{plane->normal, plane->normal.dot(plane->origin)};
    const double threshold = std::clamp(3.0 * plane->sigma_m, 1e-4, 1.5 * search.threshold_m);
    std::vector<int> inliers = Within(points, half, threshold);
    if (inliers == found.inliers) break;
    found.inliers = std::move(inliers);
  }
  return found;
}

}  // namespace sextant
