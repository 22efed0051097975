// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/cost_function.h>

#include <vector>

#include "solvers/rig/rig_model.h"

namespace sextant {

/// The residuals of a block at sensor_from_root * root_from_board * board_from_moved *
/// board_from_seen. Parameters: the sensor's pose, the placement's (board, shifts, motion), each
/// shared number, and the sensor's time offset where the block has one. A block of which all
/// weights are 0 is not evaluated.
class RigBlockCost final : public ceres::CostFunction {
 public:
  RigBlockCost(const RigBlock& block, const RigPlacementModel& placement,
               const std::vector<double>& weights);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  void SetZero(double* residuals, double** jacobians) const;

  const RigBlock& block_;
  int shift_;
  int poses_;
  int motion_;  ///< Index of its first pose, or -1.
  const std::vector<double>& weights_;
};

/// Weighted (rotation times lever, translation) of one shift. Parameters: the placement's.
class ShiftCost final : public ceres::CostFunction {
 public:
  ShiftCost(const RigPlacementModel& placement, std::size_t shift, const Vector6d& weights_by_m);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  std::size_t shift_;
  double lever_m_;
  int poses_;
  const Vector6d& weights_by_m_;
};

/// The prior of a placement's motion (kMotionSigmas). Parameters: the placement's.
class MotionCost final : public ceres::CostFunction {
 public:
  explicit MotionCost(const RigPlacementModel& placement);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  int first_;
  int poses_;
};

}  // namespace sextant
