// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/cost_function.h>

#include <memory>

namespace sextant {

/// A cost with many residuals r and few parameters as one with few residuals: with the Cholesky
/// factor [R s; 0 t] of [J r]^T [J r], the residuals are (s, t) and the derivatives (R, 0). Cost,
/// gradient and J^T J are the same to rounding, at every state.
class CondensedCost final : public ceres::CostFunction {
 public:
  /// For the first parameter block, only the columns [first, first + count) of the derivative may
  /// differ from 0; for the others, all may.
  CondensedCost(std::unique_ptr<ceres::CostFunction> all, int first, int count);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  bool Condense(double const* const* parameters, double* residuals, double** jacobians) const;

  std::unique_ptr<ceres::CostFunction> all_;
  int first_;
  int count_;
  int columns_ = 0;  ///< The width of J over all blocks.
};

}  // namespace sextant
