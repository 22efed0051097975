// SPDX-License-Identifier: Apache-2.0
#include "geometry/sphere_models.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/distortion.h"

namespace sextant {
namespace {

// (x, y) / depth, where the depth is a function of the point with the given derivative.
LensImage DividedBy(double depth, const Eigen::RowVector3d& depth_by_point,
                    const Eigen::Vector3d& point) {
  LensImage image;
  image.point = point.head<2>() / depth;
  image.by_point = -(image.point / depth) * depth_by_point;
  image.by_point.leftCols<2>() += Eigen::Matrix2d::Identity() / depth;
  return image;
}

}  // namespace

std::optional<LensImage> ProjectOmnidirectional(const Camera& camera,
                                                const Eigen::Vector3d& point_in_cam) {
  const double distance = point_in_cam.norm();
  const double depth = point_in_cam.z() + camera.xi * distance;
  if (!(depth > 0.0) || !(distance + camera.xi * point_in_cam.z() > 0.0)) return std::nullopt;
  Eigen::RowVector3d by_point = camera.xi / distance * point_in_cam.transpose();
  by_point.z() += 1.0;
  LensImage image = DividedBy(depth, by_point, point_in_cam);
  const std::optional<Distorted> distorted = DistortPlane(camera, image.point);
  if (!distorted) return std::nullopt;
  image.point = distorted->point;
  image.by_point = distorted->by_undistorted * image.by_point;
  return image;
}

std::optional<Eigen::Vector3d> RayOfOmnidirectional(const Camera& camera,
                                                    const Eigen::Vector2d& image) {
  const std::optional<Eigen::Vector2d> plane = UndistortPlane(camera, image);
  if (!plane) return std::nullopt;
  const double xi = camera.xi;
  const double squared = plane->squaredNorm();
  const double under_root = 1.0 + (1.0 - xi * xi) * squared;
  if (!(under_root >= 0.0)) return std::nullopt;
  const double onto_sphere = (xi + std::sqrt(under_root)) / (1.0 + squared);
  Eigen::Vector3d ray;
  ray << onto_sphere * *plane, onto_sphere - xi;
  return ray.normalized();
}

std::optional<LensImage> ProjectDoubleSphere(const Camera& camera,
                                             const Eigen::Vector3d& point_in_cam) {
  const double xi = camera.xi;
  const double alpha = camera.alpha;
  const double w1 = alpha <= 0.5 ? alpha / (1.0 - alpha) : (1.0 - alpha) / alpha;
  const double w2 = (w1 + xi) / std::sqrt(2.0 * w1 * xi + xi * xi + 1.0);
  const double first = point_in_cam.norm();
  if (!(point_in_cam.z() > -w2 * first)) return std::nullopt;
  const double shifted = point_in_cam.z() + xi * first;
  const double second = std::hypot(point_in_cam.head<2>().norm(), shifted);
  const double depth = alpha * second + (1.0 - alpha) * shifted;
  if (!(depth > 0.0)) return std::nullopt;
  Eigen::RowVector3d shifted_by = xi / first * point_in_cam.transpose();
  shifted_by.z() += 1.0;
  Eigen::RowVector3d second_by = shifted / second * shifted_by;
  second_by.head<2>() += point_in_cam.head<2>().transpose() / second;
  return DividedBy(depth, alpha * second_by + (1.0 - alpha) * shifted_by, point_in_cam);
}

std::optional<Eigen::Vector3d> RayOfDoubleSphere(const Camera& camera,
                                                 const Eigen::Vector2d& image) {
  const double xi = camera.xi;
  const double alpha = camera.alpha;
  const double squared = image.squaredNorm();
  const double under_root = 1.0 - (2.0 * alpha - 1.0) * squared;
  if (!(under_root >= 0.0)) return std::nullopt;
  const double z = (1.0 - alpha * alpha * squared) / (alpha * std::sqrt(under_root) + 1.0 - alpha);
  const double root = z * z + (1.0 - xi * xi) * squared;
  if (!(root >= 0.0)) return std::nullopt;
  const double onto_sphere = (z * xi + std::sqrt(root)) / (z * z + squared);
  Eigen::Vector3d ray;
  ray << onto_sphere * image, onto_sphere * z - xi;
  return ray.normalized();
}

}  // namespace sextant
