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
  using Four = double __attribute__((vector_size(32)));
  using Two = double __attribute__((vector_size(16)));
  const Four four = __builtin_shufflevector(lanes, lanes, 0, 1, 2, 3) +
                    __builtin_shufflevector(lanes, lanes, 4, 5, 6, 7);
  const Two two =
      __builtin_shufflevector(four, four, 0, 1) + __builtin_shufflevector(four, four, 2, 3);
  return two[0] + two[1];
}

/// Of each two, four or eight lanes the first half of p, then that of q; or the last halves.
SEXTANT_INLINE Lanes FirstOfTwos(const Lanes& p, const Lanes& q) {
  return __builtin_shufflevector(p, q, 0, 8, 2, 10, 4, 12, 6, 14);
}
SEXTANT_INLINE Lanes LastOfTwos(const Lanes& p, const Lanes& q) {
  return __builtin_shufflevector(p, q, 1, 9, 3, 11, 5, 13, 7, 15);
}
SEXTANT_INLINE Lanes FirstOfFours(const Lanes& p, const Lanes& q) {
  return __builtin_shufflevector(p, q, 0, 1, 8, 9, 4, 5, 12, 13);
}
SEXTANT_INLINE Lanes LastOfFours(const Lanes& p, const Lanes& q) {
  return __builtin_shufflevector(p, q, 2, 3, 10, 11, 6, 7, 14, 15);
}
SEXTANT_INLINE Lanes FirstOfEight(const Lanes& p, const Lanes& q) {
  return __builtin_shufflevector(p, q, 0, 1, 2, 3, 8, 9, 10, 11);
}
SEXTANT_INLINE Lanes LastOfEight(const Lanes& p, const Lanes& q) {
  return __builtin_shufflevector(p, q, 4, 5, 6, 7, 12, 13, 14, 15);
}

SEXTANT_INLINE Lanes SumPairs(const Lanes& p, const Lanes& q) {
  return FirstOfTwos(p, q) + LastOfTwos(p, q);
}

SEXTANT_INLINE Lanes SumFours(const Lanes& p, const Lanes& q) {
  return FirstOfFours(p, q) + LastOfFours(p, q);
}

/// The sums of eight vectors side by side, in a third of the time of eight SumLanes and in an order
/// of its own: neighbours first.
SEXTANT_INLINE Lanes SumEach(const Lanes& a, const Lanes& b, const Lanes& c, const Lanes& d,
                             const Lanes& e, const Lanes& f, const Lanes& g, const Lanes& h) {
  const Lanes abcd = SumFours(SumPairs(a, b), SumPairs(c, d));
  const Lanes efgh = SumFours(SumPairs(e, f), SumPairs(g, h));
  return FirstOfEight(abcd, efgh) + LastOfEight(abcd, efgh);
}

SEXTANT_INLINE long long OrOfLanes(const LaneMask& mask) {
  using Four = long long __attribute__((vector_size(32)));
  const Four four = __builtin_shufflevector(mask, mask, 0, 1, 2, 3) |
                    __builtin_shufflevector(mask, mask, 4, 5, 6, 7);
  return (four[0] | four[1]) | (four[2] | four[3]);
}

/// Whether a comparison holds in some lane.
SEXTANT_INLINE bool AnyLane(const LaneMask& mask) { return OrOfLanes(mask) != 0; }

}  // namespace sextant
