// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <type_traits>

#include "geometry/calibration_problem.h"
#include "solvers/kernels/simd_dispatch.h"

namespace sextant {

/// Eight 2D-3D pairs, each number of all of them side by side.
template <class L>
struct EightPixelPairs {
  L u, v, x, y, z, sigma;
};

/// The first eight pairs; places beyond the last repeat the first.
///
/// A pair is a row of eight numbers (the last two, its id, are moved and not looked at), so that
/// eight loads and 22 shuffles do what would take 48 loads of single numbers.
template <class L>
SEXTANT_INLINE EightPixelPairs<L> GatherPixelPairs(std::span<const Pair2d3d> pairs) {
  static_assert(std::is_standard_layout_v<Pair2d3d> && sizeof(Pair2d3d) == sizeof(L) &&
                offsetof(Pair2d3d, pixel) == 0 && offsetof(Pair2d3d, point_in_lidar) == 16 &&
                offsetof(Pair2d3d, sigma_px) == 40);
  const std::size_t count = pairs.size();
  const auto row = [&](std::size_t k) __attribute__((always_inline)) {
    return Load<L>(pairs[k < count ? k : 0].pixel.data());
  };
  const L r0 = row(0), r1 = row(1), r2 = row(2), r3 = row(3);
  const L r4 = row(4), r5 = row(5), r6 = row(6), r7 = row(7);
  const L even01 = FirstOfTwos(r0, r1), even23 = FirstOfTwos(r2, r3);
  const L even45 = FirstOfTwos(r4, r5), even67 = FirstOfTwos(r6, r7);
  const L odd01 = LastOfTwos(r0, r1), odd23 = LastOfTwos(r2, r3);
  const L odd45 = LastOfTwos(r4, r5), odd67 = LastOfTwos(r6, r7);
  // Named by the two numbers of four pairs that stand in them.
  const L u_z_low = FirstOfFours(even01, even23), u_z_high = FirstOfFours(even45, even67);
  const L v_sigma_low = FirstOfFours(odd01, odd23), v_sigma_high = FirstOfFours(odd45, odd67);
  const L x_low = LastOfFours(even01, even23), x_high = LastOfFours(even45, even67);
  const L y_low = LastOfFours(odd01, odd23), y_high = LastOfFours(odd45, odd67);
  return {FirstOfEight(u_z_low, u_z_high), FirstOfEight(v_sigma_low, v_sigma_high),
          FirstOfEight(x_low, x_high),     FirstOfEight(y_low, y_high),
          LastOfEight(u_z_low, u_z_high),  LastOfEight(v_sigma_low, v_sigma_high)};
}

}  // namespace sextant
