// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/sized_cost_function.h>

#include <array>
#include <vector>

#include "solvers/joint/joint_model.h"

namespace sextant {

// The residual blocks of the joint problem, with analytic derivatives. The block of a view has both
// poses of its board (BoardPoses, as a PoseManifold of two). Weights belong to the problem and
// multiply the whitened residuals; one with the weight 0 is not evaluated.

/// Printed points of one tag or checkerboard. Parameters: the view's, then intrinsics if any.
class PrintedCost final : public ceres::CostFunction {
 public:
  PrintedCost(const JointModel& model, const PrintedTerm& term, const double& weight);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  bool Differentiated(const Camera& camera, const PrintedResidual& at, double* jacobian) const;

  const JointModel& model_;
  const PrintedTerm& term_;
  const double& weight_;
};

/// Face returns of one group. Parameters: the view's, then the offsets of its ranges.
class FaceCost final : public ceres::CostFunction {
 public:
  FaceCost(const JointView& view, const FaceGroup& group, const std::vector<double>& weights);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  const JointView& view_;
  const FaceGroup& group_;
  const std::vector<double>& weights_;  ///< For all face returns of the view.
};

/// Edge rays of a view. Parameters: the view's, then what shifts its sides.
class EdgeCost final : public ceres::CostFunction {
 public:
  EdgeCost(const JointModel& model, const JointView& view, const std::vector<double>& weights);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  const JointModel& model_;
  const JointView& view_;
  const std::vector<double>& weights_;
};

/// LinkError times `scale`: cam_from_lidar links the poses of a board in both sensors. Parameters:
/// cam_from_lidar, the view's.
class LinkCost final : public ceres::SizedCostFunction<6, 7, 14> {
 public:
  LinkCost(double lever_m, const Vector6d& scale) : lever_m_(lever_m), scale_(scale) {}
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  double lever_m_;
  const Vector6d& scale_;
};

/// weight (number - mean) / sigma of a shared block.
class PriorCost final : public ceres::CostFunction {
 public:
  PriorCost(const SharedBlock& block, const double& weight);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  const SharedBlock& block_;
  const double& weight_;
};

}  // namespace sextant
