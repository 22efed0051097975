// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "base/progress.h"
#include "calibrate/scene/scene_score.h"

namespace sextant {

using Matrix9d = Eigen::Matrix<double, 9, 9>;

/// The pose at which the edges of the scans coincide best with those of the images. Of optima that
/// are as good up to chance it is the one nearest to the start.
struct SceneFit {
  Rigid3d cam_from_lidar;
  /// The covariance of (dphi, dt): the spread of this optimum over the tiles of all images
  /// (sandwich estimate, H^-1 G H^-1), and what no scene averages out: time between the sensors,
  /// motion during a turn, the width of the beam (0.05 deg and 12 mm per axis).
  Matrix6d own_covariance = Matrix6d::Zero();
  /// The same with the spread over the other optima that are as good.
  Matrix6d covariance = Matrix6d::Zero();
  double score = 0.0;        ///< At the comparing scale, a blur of 3 pixels.
  double start_score = 0.0;  ///< The score of the start.
  double chance_mean = 0.0;  ///< What coincides by chance: poses off by 2.5 to 5 deg.
  double chance_sigma = 0.0;
  /// How much better than by chance the edges of each half of the scenes coincide at the optimum of
  /// the other half, in sigmas of chance; about normal with sigma 1 for scans that do not belong to
  /// their images.
  double held_out = 0.0;
  /// The squared Mahalanobis distance between the optima of the halves, by four times the
  /// covariance; its mean is 6 if the covariance is right.
  double halves_distance = 0.0;
  double focal_px = 0.0;  ///< The focal length of the first camera.
  int edges = 0;          ///< In view.
  int scenes = 0;         ///< That differ.
  int tiles = 0;          ///< On which the spread rests.

  /// The optimum of pose and intrinsics, with its covariance by the tiles (0.2 % of the focal
  /// length are what no scene averages out).
  SceneModel free;
  Matrix9d free_covariance = Matrix9d::Zero();
  double free_score = 0.0;
  /// The intrinsics that suit the given pose best.
  Eigen::Vector3d only_intrinsics = Eigen::Vector3d::Zero();
  double only_intrinsics_score = 0.0;
};

/// Searches up to about 2.5 deg and 15 cm around `start`: a grid of rotations at the coarsest
/// scale, then Newton's method from the best cells, from coarse to fine. Time: about 50 us for each
/// edge; 0.5 s for ten pairs.
SceneFit SearchScenes(std::span<const ScenePair> pairs, const Rigid3d& start,
                      const ProgressCallback& progress = {});

}  // namespace sextant
