// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "base/units.h"

namespace sextant {

/// The angle in degrees such that kRadPerDeg times it gives the same bits again; a whole number
/// where one does.
inline double ExactDegrees(double angle_rad) {
  const double degrees = angle_rad / kRadPerDeg;
  for (const double candidate : {std::round(degrees), degrees, std::nextafter(degrees, -1e9),
                                 std::nextafter(degrees, 1e9)}) {
    if (kRadPerDeg * candidate == angle_rad) return candidate;
  }
  return degrees;
}

}  // namespace sextant
