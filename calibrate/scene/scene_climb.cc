// SPDX-License-Identifier: Apache-2.0
#include "calibrate/scene/scene_climb.h"

#include <algorithm>

#include "base/units.h"
#include "geometry/symmetric.h"

namespace sextant {
namespace {

struct UnknownRange {
  int begin;
  int end;
};

UnknownRange UnknownsOf(SceneUnknowns unknowns) {
  return {unknowns == SceneUnknowns::kIntrinsics ? 6 : 0, unknowns == SceneUnknowns::kPose ? 6 : 9};
}

Vector9d DifferenceOf(const SceneModel& model, const SceneModel& reference) {
  Vector9d difference;
  difference << PoseDifference(model.cam_from_lidar, reference.cam_from_lidar),
      model.intrinsics - reference.intrinsics;
  return difference;
}

// Newton's method with bounded steps; a step must raise the score.
SceneModel ClimbLevel(const SceneObjective& scenes, int level, SceneModel model) {
  constexpr int kMaxSteps = 6;
  constexpr double kMaxStep = 1.5;
  constexpr double kDone = 0.02;
  const Vector9d scale = ScaleOf(scenes, level);
  SceneScore here = scenes.At(level, model);
  for (int i = 0; i < kMaxSteps; ++i) {
    const Eigen::MatrixXd inverse = BoundedInverse(CurvatureOf(scenes, level, model, scale), 0.02);
    Vector9d step = inverse * here.gradient.cwiseProduct(scale);
    if (step.norm() > kMaxStep) step *= kMaxStep / step.norm();
    bool raised = false;
    for (int halvings = 0; halvings < 4 && !raised; ++halvings) {
      const SceneModel next = Perturb(model, step.cwiseProduct(scale));
      const SceneScore there = scenes.At(level, next);
      raised = there.value > here.value;
      if (raised) {
        model = next;
        here = there;
      } else {
        step *= 0.5;
      }
    }
    if (!raised || step.norm() < kDone) break;
  }
  return model;
}

}  // namespace

SceneScore SceneObjective::At(int level, const SceneModel& model) const {
  constexpr double kWeight = 0.15;
  constexpr double kRotation_rad = 2.0 * kRadPerDeg;
  constexpr double kTranslation_m = 0.1;
  constexpr double kIntrinsics = 0.05;
  SceneScore score = ScoreScenes(pairs, level, model, level > 0 ? stride : 1);
  Vector9d precision;
  precision << Eigen::Vector3d::Constant(kWeight / (kRotation_rad * kRotation_rad)),
      Eigen::Vector3d::Constant(kWeight / (kTranslation_m * kTranslation_m)),
      Eigen::Vector3d::Constant(kWeight / (kIntrinsics * kIntrinsics));
  const Vector9d moved = DifferenceOf(model, start);
  score.value -= 0.5 * moved.dot(precision.cwiseProduct(moved));
  score.gradient -= precision.cwiseProduct(moved);
  const UnknownRange range = UnknownsOf(unknowns);
  score.gradient.head(range.begin).setZero();
  score.gradient.tail(9 - range.end).setZero();
  return score;
}

Vector9d ScaleOf(const SceneObjective& scenes, int level) {
  const ScenePair& first = scenes.pairs.front();
  const double angle = first.fields.SigmaPx(level) / first.camera.fx_px;
  Vector9d scale;
  scale << angle, angle, angle, kTypicalDepth_m * Eigen::Vector3d::Constant(angle), 2.0 * angle,
      angle, angle;
  return scale;
}

Eigen::MatrixXd CurvatureOf(const SceneObjective& scenes, int level, const SceneModel& model,
                            const Vector9d& scale) {
  constexpr double kStep = 0.7;
  const UnknownRange range = UnknownsOf(scenes.unknowns);
  Eigen::MatrixXd curvature = Eigen::MatrixXd::Zero(9, 9);
  for (int i = range.begin; i < range.end; ++i) {
    const Vector9d delta = kStep * scale(i) * Vector9d::Unit(i);
    const Vector9d ahead = scenes.At(level, Perturb(model, delta)).gradient;
    const Vector9d back = scenes.At(level, Perturb(model, Vector9d(-delta))).gradient;
    curvature.col(i) = (back - ahead).cwiseProduct(scale) / (2.0 * kStep);
  }
  return 0.5 * (curvature + curvature.transpose());
}

Eigen::MatrixXd BoundedInverse(const Eigen::MatrixXd& curvature, double least) {
  const SymmetricEigen<Eigen::Dynamic> eigen = EigenOf<Eigen::Dynamic>(curvature);
  const double top = std::max(eigen.values.cwiseAbs().maxCoeff(), 1e-12);
  const Eigen::VectorXd inverse = eigen.values.cwiseMax(least * top).cwiseInverse();
  return eigen.vectors * inverse.asDiagonal() * eigen.vectors.transpose();
}

SceneModel Climb(const SceneObjective& scenes, SceneModel model, int from_level, int to_level) {
  for (int level = from_level; level >= to_level; --level) {
    model = ClimbLevel(scenes, level, model);
  }
  return model;
}

}  // namespace sextant
