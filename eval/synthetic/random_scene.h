// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/random.h"
#include "geometry/calibration_problem.h"

namespace sextant {

struct RandomSceneOptions {
  int pairs = 8;
  double sigma_m = 0.0;   ///< Noise of the camera points per axis; stated in the pairs if positive.
  double sigma_px = 0.0;  ///< Noise of the pixels per axis; stated in the pairs if positive.
  bool planar = false;    ///< All points lie on one plane of random tilt.
  double depth_m = 3.0;   ///< Distance of the points' centre from the camera.
  double extent_m = 1.0;  ///< Half the side of the cube that holds the points.
  double max_rotation_rad = 3.14;
  /// The pairs are the corners of square boards of random tilt, four of each, 0.4 extent_m from its
  /// centre.
  bool on_boards = false;
  /// Standard deviation of the error that the pairs of a board have in common, in units of sigma_m
  /// and sigma_px; the pairs do not state it.
  double shared_error = 0.0;
  bool states_noise = true;  ///< False: no pair states a sigma.
};

struct RandomScene {
  CalibrationProblem problem;
  Rigid3d cam_from_lidar;  ///< The truth.
};

/// Random pose and points in front of a camera of 1280 x 720 pixels and f = 700 px: 3D-3D pairs,
/// 2D-3D pairs of the same points, and point sets. The same generator state gives the same scene.
RandomScene MakeRandomScene(const RandomSceneOptions& options, Random& random);

}  // namespace sextant
