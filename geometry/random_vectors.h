// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "base/random.h"

namespace sextant {

/// Standard normal along each axis, drawn x first.
inline Eigen::Vector3d NormalVector(Random& random) {
  Eigen::Vector3d v;
  for (int i = 0; i < 3; ++i) v[i] = random.Normal();
  return v;
}

/// Uniform in a cube about the origin, drawn x first.
inline Eigen::Vector3d UniformVector(Random& random, double half_side) {
  Eigen::Vector3d v;
  for (int i = 0; i < 3; ++i) v[i] = random.Uniform(-half_side, half_side);
  return v;
}

}  // namespace sextant
