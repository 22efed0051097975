// SPDX-License-Identifier: Apache-2.0
#include "solvers/refine/barron_loss.h"

#include <cmath>

namespace sextant {
namespace {

// Closer to 0 or 2 than this, the rounding of the general formula exceeds the error of the limit.
constexpr double kAtLimit = 1e-7;

}  // namespace

void BarronLoss::Evaluate(double s, double out[3]) const {
  const double gap = 2.0 - a_;
  if (gap < kAtLimit) {
    out[0] = s;
    out[1] = 1.0;
    out[2] = 0.0;
    return;
  }
  const double x = s / c_squared_;
  if (std::abs(a_) < kAtLimit) {
    const double base = 1.0 + 0.5 * x;
    out[0] = 2.0 * c_squared_ * std::log1p(0.5 * x);
    out[1] = 1.0 / base;
    out[2] = -0.5 / (c_squared_ * base * base);
    return;
  }
  const double base = 1.0 + x / gap;
  const double log_base = std::log1p(x / gap);
  out[0] = 2.0 * c_squared_ * gap / a_ * std::expm1(0.5 * a_ * log_base);
  out[1] = std::pow(base, 0.5 * a_ - 1.0);
  out[2] = -0.5 / c_squared_ * std::pow(base, 0.5 * a_ - 2.0);
}

}  // namespace sextant
