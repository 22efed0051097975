// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>

#include "geometry/rigid3d.h"

namespace sextant {

/// The step -(H + damping diag H)^-1 g of the normal equations by L D L^T of fixed size: Eigen's
/// takes three times as long. None where a pivot is not positive.
inline std::optional<Vector6d> DampedStep(const Matrix6d& information, const Vector6d& gradient,
                                          double damping) {
  Matrix6d l = information;
  Matrix6d ld;  // l(i, k) d(k)
  Vector6d inverse_d;
  Vector6d x = -gradient;
  for (int j = 0; j < 6; ++j) {
    double d = (1.0 + damping) * l(j, j);
    for (int k = 0; k < j; ++k) d -= l(j, k) * ld(j, k);
    if (!(d > 0.0)) return std::nullopt;
    inverse_d[j] = 1.0 / d;
    for (int i = j + 1; i < 6; ++i) {
      double sum = l(i, j);
      for (int k = 0; k < j; ++k) sum -= l(i, k) * ld(j, k);
      ld(i, j) = sum;
      l(i, j) = sum * inverse_d[j];
    }
    for (int i = j + 1; i < 6; ++i) x[i] -= l(i, j) * x[j];
  }
  x.array() *= inverse_d.array();
  for (int j = 5; j > 0; --j) {
    for (int i = 0; i < j; ++i) x[i] -= l(j, i) * x[j];
  }
  return x;
}

/// Perturb to second order in dphi, without sine and cosine: accurate enough for a step of an
/// iteration.
inline Rigid3d Moved(const Rigid3d& pose, const Vector6d& step) {
  const Eigen::Quaterniond turn(1.0, 0.5 * step[0], 0.5 * step[1], 0.5 * step[2]);
  return {(turn * pose.rotation).normalized(), pose.translation + step.tail<3>()};
}

/// The size of a step: the larger of |dphi| [rad] and |dt| / (1 + |t|) [m].
inline double SizeOf(const Vector6d& step, const Rigid3d& pose) {
  return std::max(step.head<3>().norm(), step.tail<3>().norm() / (1.0 + pose.translation.norm()));
}

}  // namespace sextant
