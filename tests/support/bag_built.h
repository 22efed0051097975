// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

namespace sextant::test {

#ifdef SEXTANT_WITH_BAG
inline constexpr bool kBagIsBuilt = true;
#else
inline constexpr bool kBagIsBuilt = false;
#endif

}  // namespace sextant::test

#define SKIP_WHERE_NOT_BUILT() \
  if (!sextant::test::kBagIsBuilt) GTEST_SKIP() << "built without recordings of ROS (SEXTANT_BAG)"
