// SPDX-License-Identifier: Apache-2.0
#include "eval/synthetic/random_scene.h"

#include <cmath>

#include "eval/synthetic/typical_sensors.h"
#include "geometry/random_vectors.h"

namespace sextant {
namespace {

/// Points in the cube of the scene, and what those of a board have in common. Draws nothing for
/// options that are not set, so that scenes do not depend on options that they lack.
class ScenePoints {
 public:
  ScenePoints(const RandomSceneOptions& options, Random& random)
      : options_(options), random_(random) {}

  /// The offset of point i from the centre of the cube.
  Eigen::Vector3d Offset(int i) {
    constexpr double kBoardRadius = 0.4;
    if (!options_.on_boards) return UniformVector(random_, options_.extent_m);
    if (i % kCornersPerBoard == 0) {
      const double reach = (1.0 - kBoardRadius) * options_.extent_m;
      centre_ = UniformVector(random_, reach);
      tilt_ = ExpSo3(UniformVector(random_, 0.6));
    }
    constexpr double kRightAngle = 1.5707963267948966;
    const double angle = kRightAngle * (i % kCornersPerBoard);
    const Eigen::Vector3d corner(std::sin(angle), -std::cos(angle), 0.0);
    return centre_ + tilt_ * corner * kBoardRadius * options_.extent_m;
  }

  /// The error common to the board of point i, 3D and in the image, in units of the noise.
  void DrawShared(int i) {
    if (options_.shared_error == 0.0 || i % kCornersPerBoard != 0) return;
    in_cam_ = options_.shared_error * NormalVector(random_);
    in_image_ = options_.shared_error * NormalVector(random_).head<2>();
  }
  const Eigen::Vector3d& in_cam() const { return in_cam_; }
  const Eigen::Vector2d& in_image() const { return in_image_; }

 private:
  const RandomSceneOptions& options_;
  Random& random_;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  Eigen::Quaterniond tilt_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d in_cam_ = Eigen::Vector3d::Zero();
  Eigen::Vector2d in_image_ = Eigen::Vector2d::Zero();
};

}  // namespace

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
  ScenePoints points(options, random);
  for (int i = 0; i < options.pairs; ++i) {
    Eigen::Vector3d offset = points.Offset(i);
    points.DrawShared(i);
    if (options.planar) offset.z() = 0.0;
    const Eigen::Vector3d in_cam = tilt * offset + Eigen::Vector3d(0.0, 0.0, options.depth_m);
    const Eigen::Vector3d noise_m =
        options.sigma_m * NormalVector(random) + options.sigma_m * points.in_cam();
    const double noise_u = options.sigma_px * random.Normal();
    const double noise_v = options.sigma_px * random.Normal();
    const PairId id{.view = 0, .board = i / kCornersPerBoard, .corner = i % kCornersPerBoard};
    const Eigen::Vector3d in_lidar = lidar_from_cam * in_cam;
    problem.pairs_3d3d.push_back({.point_in_cam = in_cam + noise_m,
                                  .point_in_lidar = in_lidar,
                                  .sigma_m = options.states_noise ? options.sigma_m : 0.0,
                                  .covariance_in_cam = {},
                                  .id = id});
    const Eigen::Vector2d pixel = *Project(*problem.camera, in_cam) +
                                  Eigen::Vector2d(noise_u, noise_v) +
                                  options.sigma_px * points.in_image();
    problem.pairs_2d3d.push_back({.pixel = pixel,
                                  .point_in_lidar = in_lidar,
                                  .sigma_px = options.states_noise ? options.sigma_px : 0.0,
                                  .id = id});
  }
  problem.point_sets = WithholdPairing(problem.pairs_3d3d);
  return scene;
}

}  // namespace sextant
