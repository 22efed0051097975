// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/ceres.h>

#include "solvers/least_squares/term_derivatives.h"
#include "solvers/refine/rotation_manifold.h"

namespace sextant {

/// The residual of one pair and its derivatives by (dphi, dt), lifted to the quaternion: Ceres
/// multiplies by PlusJacobian, whose left inverse is MinusJacobian. Null entries of `jacobians` are
/// skipped.
template <int kResiduals>
bool WritePoseCost(const TermDerivatives<kResiduals>& at, const double* rotation, double* residuals,
                   double** jacobians) {
  // Ceres logs values that are not finite, but not a false return.
  const Eigen::Matrix<double, kResiduals, 6> jacobian = at.Jacobian();
  if (!at.residual.allFinite() || !jacobian.allFinite()) return false;
  Eigen::Map<Eigen::Matrix<double, kResiduals, 1>> residual(residuals);
  residual = at.residual;
  if (jacobians == nullptr) return true;
  if (jacobians[0] != nullptr) {
    Eigen::Matrix<double, 3, 4, Eigen::RowMajor> lift;
    RotationManifold().MinusJacobian(rotation, lift.data());
    Eigen::Map<Eigen::Matrix<double, kResiduals, 4, Eigen::RowMajor>> by_rotation(jacobians[0]);
    by_rotation = jacobian.template leftCols<3>() * lift;
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, kResiduals, 3, Eigen::RowMajor>> by_shift(jacobians[1]);
    by_shift = jacobian.template rightCols<3>();
  }
  return true;
}

/// The residual of a pair as a function of the pose (quaternion, translation); the camera is
/// constant.
template <class Term, int kResiduals>
class PairCost final : public ceres::SizedCostFunction<kResiduals, 4, 3> {
 public:
  PairCost(const Term& term, const Camera* camera) : term_(term), camera_(camera) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const Eigen::Map<const Eigen::Quaterniond> rotation(parameters[0]);
    const Eigen::Map<const Eigen::Vector3d> translation(parameters[1]);
    TermDerivatives<kResiduals> at;
    if (!Differentiate(term_, camera_, rotation.toRotationMatrix(), translation, at)) return false;
    return WritePoseCost(at, parameters[0], residuals, jacobians);
  }

 private:
  Term term_;
  const Camera* camera_;
};

}  // namespace sextant
