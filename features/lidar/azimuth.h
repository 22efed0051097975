// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

namespace sextant {

/// Wraps an angle within a few turns to [-pi, pi]; much faster than a remainder.
inline double WrapAngle(double angle_rad) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  while (angle_rad > std::numbers::pi) angle_rad -= kTurn;
  while (angle_rad < -std::numbers::pi) angle_rad += kTurn;
  return angle_rad;
}

}  // namespace sextant
