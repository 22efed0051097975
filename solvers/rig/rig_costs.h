// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/cost_function.h>
#include <ceres/manifold.h>

#include <vector>

#include "solvers/rig/rig_model.h"

namespace sextant {

/// Any number of poses with the library's perturbation as one parameter block; see PoseManifold, of
/// which this is the form for a number that is known when the program runs.
class PosesManifold final : public ceres::Manifold {
 public:
  explicit PosesManifold(int poses) : poses_(poses) {}

  int AmbientSize() const override;
  int TangentSize() const override;
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;

 private:
  int poses_;
};

/// The residuals of a block at sensor_from_root * root_from_board * board_from_seen. Parameters:
/// the sensor's pose, the placement's (board, then shifts), each shared number.
class RigBlockCost final : public ceres::CostFunction {
 public:
  RigBlockCost(const RigBlock& block, const RigPlacementModel& placement,
               const std::vector<double>& weights);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  const RigBlock& block_;
  int shift_;
  int poses_;
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

}  // namespace sextant
