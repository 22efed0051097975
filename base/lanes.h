// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstring>

/// Compiles a function for SSE2, AVX2 and AVX-512; the loader picks what the machine has. Only what
/// is inlined into the function follows: helpers must be SEXTANT_INLINE, and lambdas are not.
/// Sanitizers cannot run the loader's choice.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(SEXTANT_SANITIZED)
#define SEXTANT_MULTIVERSION __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define SEXTANT_MULTIVERSION
#endif
#define SEXTANT_INLINE inline __attribute__((always_inline))

namespace sextant {

/// Eight doubles computed on side by side, by as many registers as the machine needs for them: the
/// width, and with it every rounding, is the same on all machines. + - * / and comparisons work
/// element by element; `mask ? a : b` selects. Never passed to a function that is not inlined.
using Lanes = double __attribute__((vector_size(64)));

/// What a comparison of Lanes gives: -1 where it holds, 0 where not.
using LaneMask = long long __attribute__((vector_size(64)));

inline constexpr std::size_t kLanes = 8;

SEXTANT_INLINE Lanes AllLanes(double value) {
  return Lanes{value, value, value, value, value, value, value, value};
}

/// Eight doubles from any address.
SEXTANT_INLINE Lanes LoadLanes(const double* from) {
  Lanes lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}

SEXTANT_INLINE void StoreLanes(const Lanes& lanes, double* to) {
  std::memcpy(to, &lanes, sizeof lanes);
}

SEXTANT_INLINE Lanes Sqrt(const Lanes& lanes) {
  Lanes roots;
  for (std::size_t i = 0; i < kLanes; ++i) roots[i] = std::sqrt(lanes[i]);
  return roots;
}

SEXTANT_INLINE Lanes Abs(const Lanes& lanes) { return lanes < 0.0 ? -lanes : lanes; }

SEXTANT_INLINE Lanes Min(const Lanes& a, const Lanes& b) { return b < a ? b : a; }

SEXTANT_INLINE Lanes Max(const Lanes& a, const Lanes& b) { return a < b ? b : a; }

/// The sum, always in the same order: halves onto each other.
SEXTANT_INLINE double SumLanes(const Lanes& lanes) {
  return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) +
         ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
}

}  // namespace sextant
