// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include "geometry/rigid3d.h"

namespace sextant::test {

inline void ExpectSamePose(const Rigid3d& a, const Rigid3d& b, double tolerance) {
  const PoseDistance distance = DistanceBetween(a, b);
  EXPECT_LT(distance.rotation_rad, tolerance);
  EXPECT_LT(distance.translation_m, tolerance);
}

}  // namespace sextant::test
