// SPDX-License-Identifier: Apache-2.0
#include "simulator/scene/corner_noise.h"

#include <cmath>

#include "geometry/random_vectors.h"

namespace sextant {
namespace {

Eigen::Matrix3d CameraCovariance(const CornerNoise& noise, const Eigen::Vector3d& ray) {
  const double lateral = noise.camera_lateral_sigma_m * noise.camera_lateral_sigma_m;
  const double depth = noise.camera_depth_sigma_m * noise.camera_depth_sigma_m;
  return lateral * Eigen::Matrix3d::Identity() + (depth - lateral) * ray * ray.transpose();
}

}  // namespace

void AddMeasuredCorner(const CornerNoise& noise, const PairId& id, const Eigen::Vector3d& in_cam,
                       const Eigen::Vector3d& in_lidar, const Eigen::Vector2d& pixel,
                       Random& random, CalibrationProblem& problem) {
  const Eigen::Vector3d ray = in_cam.normalized();
  const Eigen::Vector3d lateral_noise = noise.camera_lateral_sigma_m * NormalVector(random);
  const double depth_noise = noise.camera_depth_sigma_m * random.Normal();
  const Eigen::Vector3d lidar_noise = noise.lidar_sigma_m * NormalVector(random);
  Eigen::Vector2d measured_px = pixel;
  for (int i = 0; i < 2; ++i) measured_px[i] += noise.pixel_sigma_px * random.Normal();

  const Eigen::Vector3d measured_in_cam =
      in_cam + lateral_noise - lateral_noise.dot(ray) * ray + depth_noise * ray;
  const double lidar_variance = noise.lidar_sigma_m * noise.lidar_sigma_m;
  problem.pairs_3d3d.push_back({.point_in_cam = measured_in_cam,
                                .point_in_lidar = in_lidar + lidar_noise,
                                .covariance_in_cam = CameraCovariance(noise, ray) +
                                                     lidar_variance * Eigen::Matrix3d::Identity(),
                                .id = id});
  // A LiDAR error across the ray shifts the projection by f / z pixels per metre.
  const double lidar_px = problem.camera->fx_px / in_cam.z() * noise.lidar_sigma_m;
  problem.pairs_2d3d.push_back({.pixel = measured_px,
                                .point_in_lidar = in_lidar + lidar_noise,
                                .sigma_px = std::hypot(noise.pixel_sigma_px, lidar_px),
                                .id = id});
}

}  // namespace sextant
