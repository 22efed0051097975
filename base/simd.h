// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstring>

/// Vectors of 8 doubles. solvers/kernels and the model of a tag's image (features/camera) are the
/// only users of explicit vector code.
///
/// Why explicit: g++ 12 does not vectorise these loops, since floating-point sums may not be
/// reordered and the data are structures. Measured on one core, scalar to vector (all figures in
/// docs/performance_notes.md): kabsch of 100 pairs 365 to 225 ns, of 1000 pairs 2.5 to 1.05 us;
/// least squares of 20 pixels 4.8 to 1.3 us; p3p 285 ns for one triple, 75 ns each for eight.
/// Where the machine has AVX2 and not AVX-512, g++ 12 breaks comparisons and shuffles of 64-byte
/// vectors into scalars; SplitVec8d (solvers/kernels/simd_dispatch.h) avoids that: kabsch of 100
/// pairs 826 to 262 ns. Every sum has a fixed order, so all machines give the same bits.

/// Compiles a function for SSE2, AVX2 and AVX-512; the loader picks the best that the machine has.
/// Only code that is inlined into the function is compiled for each: helpers must be
/// SEXTANT_INLINE, and lambdas need the attribute too. Off with sanitizers, which cannot run the
/// loader's choice.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(SEXTANT_SANITIZED)
#define SEXTANT_MULTIVERSION __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define SEXTANT_MULTIVERSION
#endif
#define SEXTANT_INLINE inline __attribute__((always_inline))

namespace sextant {

/// SIMD vector of 8 doubles, in as many registers as the machine needs: the width, and with it
/// every rounding, is the same on all machines. + - * / and comparisons work element by element;
/// `mask ? a : b` selects. Never passed to a function that is not inlined.
using Vec8d = double __attribute__((vector_size(64)));

/// The result of a comparison of Vec8d: -1 where it holds, 0 where not.
using Mask8 = long long __attribute__((vector_size(64)));

inline constexpr std::size_t kSimdWidth = 8;

SEXTANT_INLINE Vec8d BroadcastVec(double value) {
  return Vec8d{value, value, value, value, value, value, value, value};
}

/// Eight doubles from any address.
SEXTANT_INLINE Vec8d LoadVec(const double* from) {
  Vec8d v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

SEXTANT_INLINE void StoreVec(const Vec8d& v, double* to) { std::memcpy(to, &v, sizeof v); }

SEXTANT_INLINE Vec8d Sqrt(const Vec8d& v) {
  Vec8d roots;
  for (std::size_t i = 0; i < kSimdWidth; ++i) roots[i] = std::sqrt(v[i]);
  return roots;
}

SEXTANT_INLINE Vec8d Abs(const Vec8d& v) { return v < 0.0 ? -v : v; }

SEXTANT_INLINE Vec8d Min(const Vec8d& a, const Vec8d& b) { return b < a ? b : a; }

SEXTANT_INLINE Vec8d Max(const Vec8d& a, const Vec8d& b) { return a < b ? b : a; }

/// The sum, always in the same order: the upper half is added to the lower one until one is left.
SEXTANT_INLINE double HorizontalSum(const Vec8d& v) {
  using Four = double __attribute__((vector_size(32)));
  using Two = double __attribute__((vector_size(16)));
  const Four four =
      __builtin_shufflevector(v, v, 0, 1, 2, 3) + __builtin_shufflevector(v, v, 4, 5, 6, 7);
  const Two two =
      __builtin_shufflevector(four, four, 0, 1) + __builtin_shufflevector(four, four, 2, 3);
  return two[0] + two[1];
}

/// For each group of two, four or eight elements: the first half of p, then that of q; or the last
/// halves.
SEXTANT_INLINE Vec8d FirstOfTwos(const Vec8d& p, const Vec8d& q) {
  return __builtin_shufflevector(p, q, 0, 8, 2, 10, 4, 12, 6, 14);
}
SEXTANT_INLINE Vec8d LastOfTwos(const Vec8d& p, const Vec8d& q) {
  return __builtin_shufflevector(p, q, 1, 9, 3, 11, 5, 13, 7, 15);
}
SEXTANT_INLINE Vec8d FirstOfFours(const Vec8d& p, const Vec8d& q) {
  return __builtin_shufflevector(p, q, 0, 1, 8, 9, 4, 5, 12, 13);
}
SEXTANT_INLINE Vec8d LastOfFours(const Vec8d& p, const Vec8d& q) {
  return __builtin_shufflevector(p, q, 2, 3, 10, 11, 6, 7, 14, 15);
}
SEXTANT_INLINE Vec8d FirstOfEight(const Vec8d& p, const Vec8d& q) {
  return __builtin_shufflevector(p, q, 0, 1, 2, 3, 8, 9, 10, 11);
}
SEXTANT_INLINE Vec8d LastOfEight(const Vec8d& p, const Vec8d& q) {
  return __builtin_shufflevector(p, q, 4, 5, 6, 7, 12, 13, 14, 15);
}

SEXTANT_INLINE Vec8d SumPairs(const Vec8d& p, const Vec8d& q) {
  return FirstOfTwos(p, q) + LastOfTwos(p, q);
}

SEXTANT_INLINE Vec8d SumFours(const Vec8d& p, const Vec8d& q) {
  return FirstOfFours(p, q) + LastOfFours(p, q);
}

/// The sums of eight vectors as the elements of one, in a third of the time of eight HorizontalSum
/// and in another order: neighbours first.
SEXTANT_INLINE Vec8d SumEach(const Vec8d& a, const Vec8d& b, const Vec8d& c, const Vec8d& d,
                             const Vec8d& e, const Vec8d& f, const Vec8d& g, const Vec8d& h) {
  const Vec8d abcd = SumFours(SumPairs(a, b), SumPairs(c, d));
  const Vec8d efgh = SumFours(SumPairs(e, f), SumPairs(g, h));
  return FirstOfEight(abcd, efgh) + LastOfEight(abcd, efgh);
}

SEXTANT_INLINE long long HorizontalOr(const Mask8& mask) {
  using Four = long long __attribute__((vector_size(32)));
  const Four four = __builtin_shufflevector(mask, mask, 0, 1, 2, 3) |
                    __builtin_shufflevector(mask, mask, 4, 5, 6, 7);
  return (four[0] | four[1]) | (four[2] | four[3]);
}

/// Whether a comparison holds for any element.
SEXTANT_INLINE bool AnyTrue(const Mask8& mask) { return HorizontalOr(mask) != 0; }

}  // namespace sextant
