// SPDX-License-Identifier: Apache-2.0
#include "eval/synthetic/random_scene.h"

#include "eval/synthetic/typical_sensors.h"
#include "geometry/random_vectors.h"

namespace sextant {
RandomScene MakeRandomScene(const RandomSceneOptions& options, Random& random) {
  RandomScene scene;
  const Eigen::Vector3d axis = NormalVector(random).normalized();
  const double angle = random.Uniform(0.0, options.max_rotation_rad);
  scene.cam_from_lidar.rotation = ExpSo3(axis * angle);
  scene.cam_from_lidar.translation = UniformVector(random, 0.5);
  const Rigid3d lidar_from_cam = scene.cam_from_lidar.Inverse();

  CalibrationProblem& problem = scene.problem;
  problem.camera = ZedLikeCamera();
  const Eigen::Quaterniond tilt = ExpSo3(UniformVector(random, 0.6));
  for (int i = 0; i < options.pairs; ++i) {
    Eigen::Vector3d offset = UniformVector(random, options.extent_m);
    if (options.planar) offset.z() = 0.0;
    const Eigen::Vector3d in_cam = tilt * offset + Eigen::Vector3d(0.0, 0.0, options.depth_m);
    const Eigen::Vector3d noise_m = options.sigma_m * NormalVector(random);
    const double noise_u = options.sigma_px * random.Normal();
    const double noise_v = options.sigma_px * random.Normal();
    const PairId id{.view = 0, .board = i / kCornersPerBoard, .corner = i % kCornersPerBoard};
    const Eigen::Vector3d in_lidar = lidar_from_cam * in_cam;
    problem.pairs_3d3d.push_back({.point_in_cam = in_cam + noise_m,
                                  .point_in_lidar = in_lidar,
                                  .sigma_m = options.sigma_m,
                                  .covariance_in_cam = {},
                                  .id = id});
    const Eigen::Vector2d pixel =
        *Project(*problem.camera, in_cam) + Eigen::Vector2d(noise_u, noise_v);
    problem.pairs_2d3d.push_back(
        {.pixel = pixel, .point_in_lidar = in_lidar, .sigma_px = options.sigma_px, .id = id});
  }
  problem.point_sets = WithholdPairing(problem.pairs_3d3d);
  return scene;
}

}  // namespace sextant
