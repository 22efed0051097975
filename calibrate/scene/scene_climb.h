// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "calibrate/scene/scene_score.h"

namespace sextant {

/// What is estimated of a SceneModel; the rest keeps the values of the start.
enum class SceneUnknowns { kPose, kIntrinsics, kBoth };

/// The score of the scenes with a weak prior around the start, which holds directions that the
/// scenes leave open: 2 deg, 0.1 m, 5 % of the focal length.
struct SceneObjective {
  std::span<const ScenePair> pairs;
  SceneModel start;
  std::size_t stride = 1;  ///< The coarse levels use one edge in so many.
  SceneUnknowns unknowns = SceneUnknowns::kPose;

  /// The gradient of what is not estimated is 0.
  SceneScore At(int level, const SceneModel& model) const;
};

/// Turns a rotation into a translation of like effect.
inline constexpr double kTypicalDepth_m = 8.0;

/// What moves an edge by about one blur of the level, at typical depth.
Vector9d ScaleOf(const SceneObjective& scenes, int level);

/// Minus the second derivative of the score in steps of `scale`, by central differences of
/// gradients; rows and columns of what is not estimated are 0.
Eigen::MatrixXd CurvatureOf(const SceneObjective& scenes, int level, const SceneModel& model,
                            const Vector9d& scale);

/// The inverse with eigenvalues of at least `least` times the largest.
Eigen::MatrixXd BoundedInverse(const Eigen::MatrixXd& curvature, double least);

/// The optimum by Newton's method with bounded steps, each of which raises the score, at every
/// level from the coarse `from_level` down to `to_level`.
SceneModel Climb(const SceneObjective& scenes, SceneModel model, int from_level, int to_level);

}  // namespace sextant
