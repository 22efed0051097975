// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/loss_function.h>

namespace sextant {

/// The general adaptive loss of Barron (CVPR 2019), eq. 8, of s = |r|^2, scaled so that its slope
/// at 0 is 1 as Ceres expects:
///   rho(s) = 2 c^2 |a - 2| / a * ((s / c^2 / |a - 2| + 1)^(a / 2) - 1), with its limits
///   a = 2: s;  a = 0: 2 c^2 log(1 + s / (2 c^2)).
/// a = 1 is the smooth Huber (Charbonnier), 0 Cauchy, -2 Geman-McClure; below 0 it is bounded.
class BarronLoss final : public ceres::LossFunction {
 public:
  /// Requires a <= 2 and c > 0 (in the unit of r).
  BarronLoss(double a, double c) : a_(a), c_squared_(c * c) {}

  /// out = rho, rho', rho''.
  void Evaluate(double s, double out[3]) const override;

 private:
  double a_;
  double c_squared_;
};

}  // namespace sextant
