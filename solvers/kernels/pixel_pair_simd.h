// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <type_traits>

#include "geometry/calibration_problem.h"
#include "solvers/kernels/simd_dispatch.h"

namespace sextant {

/// Eight 2D-3D pairs, one vector for each of their numbers.
template <class V>
struct EightPixelPairs {
  V u, v, x, y, z, sigma;
};

/// The first eight pairs; where there are fewer, the first one is repeated.
///
/// A pair is a row of eight numbers (the last two, its id, are moved but not used), so that eight
/// loads and 22 shuffles replace 48 loads of single numbers.
template <class V>
SEXTANT_INLINE EightPixelPairs<V> GatherPixelPairs(std::span<const Pair2d3d> pairs) {
  static_assert(std::is_standard_layout_v<Pair2d3d> && sizeof(Pair2d3d) == sizeof(V) &&
                offsetof(Pair2d3d, pixel) == 0 && offsetof(Pair2d3d, point_in_lidar) == 16 &&
                offsetof(Pair2d3d, sigma_px) == 40);
  const std::size_t count = pairs.size();
  const auto row = [&](std::size_t k) __attribute__((always_inline)) {
    return Load<V>(pairs[k < count ? k : 0].pixel.data());
  };
  const V r0 = row(0), r1 = row(1), r2 = row(2), r3 = row(3);
  const V r4 = row(4), r5 = row(5), r6 = row(6), r7 = row(7);
  const V even01 = FirstOfTwos(r0, r1), even23 = FirstOfTwos(r2, r3);
  const V even45 = FirstOfTwos(r4, r5), even67 = FirstOfTwos(r6, r7);
  const V odd01 = LastOfTwos(r0, r1), odd23 = LastOfTwos(r2, r3);
  const V odd45 = LastOfTwos(r4, r5), odd67 = LastOfTwos(r6, r7);
  // Named by the two numbers of four pairs that they hold.
  const V u_z_low = FirstOfFours(even01, even23), u_z_high = FirstOfFours(even45, even67);
  const V v_sigma_low = FirstOfFours(odd01, odd23), v_sigma_high = FirstOfFours(odd45, odd67);
  const V x_low = LastOfFours(even01, even23), x_high = LastOfFours(even45, even67);
  const V y_low = LastOfFours(odd01, odd23), y_high = LastOfFours(odd45, odd67);
  return {FirstOfEight(u_z_low, u_z_high), FirstOfEight(v_sigma_low, v_sigma_high),
          FirstOfEight(x_low, x_high),     FirstOfEight(y_low, y_high),
          LastOfEight(u_z_low, u_z_high),  LastOfEight(v_sigma_low, v_sigma_high)};
}

}  // namespace sextant
