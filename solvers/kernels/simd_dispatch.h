// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <type_traits>

#include "base/simd.h"

/// Defines the function `name` from its template `name`For<V>, V = Vec8d or SplitVec8d: for
/// AVX-512, AVX2 and SSE2 where the build is portable, else for one of them. The template and what
/// it calls must be SEXTANT_INLINE. Each call looks up the processor's features, by one load and a
/// branch that always goes the same way: the loader's choice would be as fast, but clang 14 then
/// drops inline functions that only its versions call, and sanitizers cannot run it.
// NOLINTBEGIN(bugprone-macro-parentheses): types and parameter lists cannot have them.
#if defined(__AVX512F__)
#define SEXTANT_SIMD_DISPATCH(Return, name, parameters, arguments) \
  Return name parameters { return name##For<Vec8d> arguments; }
#elif defined(__x86_64__) && defined(__GNUC__) && !defined(__AVX2__)
#define SEXTANT_SIMD_DISPATCH(Return, name, parameters, arguments)        \
  __attribute__((target("avx2"))) Return name##Avx2 parameters {          \
    return name##For<SplitVec8d> arguments;                               \
  }                                                                       \
  __attribute__((target("avx512f"))) Return name##Avx512 parameters {     \
    return name##For<Vec8d> arguments;                                    \
  }                                                                       \
  Return name parameters {                                                \
    if (__builtin_cpu_supports("avx512f")) return name##Avx512 arguments; \
    if (__builtin_cpu_supports("avx2")) return name##Avx2 arguments;      \
    return name##For<SplitVec8d> arguments;                               \
  }
#else
#define SEXTANT_SIMD_DISPATCH(Return, name, parameters, arguments) \
  Return name parameters { return name##For<SplitVec8d> arguments; }
#endif
// NOLINTEND(bugprone-macro-parentheses)

namespace sextant {

using Vec4d = double __attribute__((vector_size(32)));
using Mask4 = long long __attribute__((vector_size(32)));

/// Mask8 as two halves.
struct SplitMask8 {
  Mask4 low, high;
};

/// Vec8d as two registers of four, for machines without AVX-512: there g++ 12 breaks comparisons,
/// selections and shuffles of Vec8d into scalars. Every operation rounds as that of Vec8d does.
struct SplitVec8d {
  SEXTANT_INLINE double operator[](std::size_t i) const { return i < 4 ? low[i] : high[i - 4]; }

  Vec4d low, high;
};

#define SEXTANT_SPLIT_ARITHMETIC(op)                                                \
  SEXTANT_INLINE SplitVec8d operator op(const SplitVec8d& a, const SplitVec8d& b) { \
    return {a.low op b.low, a.high op b.high};                                      \
  }                                                                                 \
  SEXTANT_INLINE SplitVec8d operator op(const SplitVec8d& a, double b) {            \
    return {a.low op b, a.high op b};                                               \
  }                                                                                 \
  SEXTANT_INLINE SplitVec8d operator op(double a, const SplitVec8d& b) {            \
    return {a op b.low, a op b.high};                                               \
  }
SEXTANT_SPLIT_ARITHMETIC(+)
SEXTANT_SPLIT_ARITHMETIC(-)
SEXTANT_SPLIT_ARITHMETIC(*)
SEXTANT_SPLIT_ARITHMETIC(/)
#undef SEXTANT_SPLIT_ARITHMETIC

#define SEXTANT_SPLIT_COMPARISON(op)                                                \
  SEXTANT_INLINE SplitMask8 operator op(const SplitVec8d& a, const SplitVec8d& b) { \
    return {a.low op b.low, a.high op b.high};                                      \
  }                                                                                 \
  SEXTANT_INLINE SplitMask8 operator op(const SplitVec8d& a, double b) {            \
    return {a.low op b, a.high op b};                                               \
  }
SEXTANT_SPLIT_COMPARISON(<)
SEXTANT_SPLIT_COMPARISON(<=)
SEXTANT_SPLIT_COMPARISON(>)
#undef SEXTANT_SPLIT_COMPARISON

SEXTANT_INLINE SplitVec8d operator-(const SplitVec8d& a) { return {-a.low, -a.high}; }
SEXTANT_INLINE SplitVec8d& operator+=(SplitVec8d& a, const SplitVec8d& b) { return a = a + b; }

SEXTANT_INLINE SplitMask8 operator>=(const SplitMask8& a, long long b) {
  return {a.low >= b, a.high >= b};
}
SEXTANT_INLINE SplitMask8 operator~(const SplitMask8& a) { return {~a.low, ~a.high}; }
SEXTANT_INLINE SplitMask8 operator|(const SplitMask8& a, const SplitMask8& b) {
  return {a.low | b.low, a.high | b.high};
}
SEXTANT_INLINE SplitMask8& operator|=(SplitMask8& a, const SplitMask8& b) { return a = a | b; }

/// The result of a comparison of V.
template <class V>
using MaskOf = std::conditional_t<std::is_same_v<V, Vec8d>, Mask8, SplitMask8>;

/// Zero where the mask does not hold, also in place of NaN.
SEXTANT_INLINE Vec8d Keep(const Mask8& mask, const Vec8d& v) {
  return reinterpret_cast<Vec8d>(mask & reinterpret_cast<Mask8>(v));
}
SEXTANT_INLINE SplitVec8d Keep(const SplitMask8& mask, const SplitVec8d& v) {
  return {reinterpret_cast<Vec4d>(mask.low & reinterpret_cast<Mask4>(v.low)),
          reinterpret_cast<Vec4d>(mask.high & reinterpret_cast<Mask4>(v.high))};
}

/// `mask ? a : b`, for templates over double, Vec8d and SplitVec8d.
SEXTANT_INLINE double Select(bool mask, double a, double b) { return mask ? a : b; }
template <class Mask>
SEXTANT_INLINE Vec8d Select(const Mask& mask, const Vec8d& a, const Vec8d& b) {
  return mask ? a : b;
}
SEXTANT_INLINE SplitVec8d Select(const SplitMask8& mask, const SplitVec8d& a, const SplitVec8d& b) {
  return {mask.low ? a.low : b.low, mask.high ? a.high : b.high};
}

SEXTANT_INLINE SplitVec8d Sqrt(const SplitVec8d& a) {
  SplitVec8d roots;
  for (std::size_t i = 0; i < 4; ++i) roots.low[i] = std::sqrt(a.low[i]);
  for (std::size_t i = 0; i < 4; ++i) roots.high[i] = std::sqrt(a.high[i]);
  return roots;
}
SEXTANT_INLINE SplitVec8d Min(const SplitVec8d& a, const SplitVec8d& b) {
  return Select(b < a, b, a);
}

/// Eight numbers as a vector: doubles, or integers for a mask.
template <class V, class Number>
SEXTANT_INLINE V VecOf(Number a, Number b, Number c, Number d, Number e, Number f, Number g,
                       Number h) {
  if constexpr (std::is_class_v<V>) {
    using Half = decltype(V::low);
    return {Half{a, b, c, d}, Half{e, f, g, h}};
  } else {
    const V v = {a, b, c, d, e, f, g, h};
    return v;
  }
}

/// One number in all elements.
template <class V>
SEXTANT_INLINE V All(double value) {
  return value - V{};
}

/// Eight doubles from any address. Half by half: a copy of the whole would go through memory.
template <class V>
SEXTANT_INLINE V Load(const double* from) {
  if constexpr (std::is_class_v<V>) {
    V v;
    std::memcpy(&v.low, from, sizeof v.low);
    std::memcpy(&v.high, from + 4, sizeof v.high);
    return v;
  } else {
    return LoadVec(from);
  }
}
SEXTANT_INLINE void StoreVec(const SplitVec8d& v, double* to) {
  std::memcpy(to, &v.low, sizeof v.low);
  std::memcpy(to + 4, &v.high, sizeof v.high);
}

SEXTANT_INLINE double HorizontalSum(const SplitVec8d& v) {
  using Two = double __attribute__((vector_size(16)));
  const Vec4d four = v.low + v.high;
  const Two two =
      __builtin_shufflevector(four, four, 0, 1) + __builtin_shufflevector(four, four, 2, 3);
  return two[0] + two[1];
}

SEXTANT_INLINE Vec4d FirstOfTwos(const Vec4d& p, const Vec4d& q) {
  return __builtin_shufflevector(p, q, 0, 4, 2, 6);
}
SEXTANT_INLINE Vec4d LastOfTwos(const Vec4d& p, const Vec4d& q) {
  return __builtin_shufflevector(p, q, 1, 5, 3, 7);
}
SEXTANT_INLINE Vec4d FirstOfFours(const Vec4d& p, const Vec4d& q) {
  return __builtin_shufflevector(p, q, 0, 1, 4, 5);
}
SEXTANT_INLINE Vec4d LastOfFours(const Vec4d& p, const Vec4d& q) {
  return __builtin_shufflevector(p, q, 2, 3, 6, 7);
}
#define SEXTANT_SPLIT_SHUFFLE(name)                                          \
  SEXTANT_INLINE SplitVec8d name(const SplitVec8d& p, const SplitVec8d& q) { \
    return {name(p.low, q.low), name(p.high, q.high)};                       \
  }
SEXTANT_SPLIT_SHUFFLE(FirstOfTwos)
SEXTANT_SPLIT_SHUFFLE(LastOfTwos)
SEXTANT_SPLIT_SHUFFLE(FirstOfFours)
SEXTANT_SPLIT_SHUFFLE(LastOfFours)
#undef SEXTANT_SPLIT_SHUFFLE
SEXTANT_INLINE SplitVec8d FirstOfEight(const SplitVec8d& p, const SplitVec8d& q) {
  return {p.low, q.low};
}
SEXTANT_INLINE SplitVec8d LastOfEight(const SplitVec8d& p, const SplitVec8d& q) {
  return {p.high, q.high};
}

SEXTANT_INLINE Vec4d SumPairs(const Vec4d& p, const Vec4d& q) {
  return FirstOfTwos(p, q) + LastOfTwos(p, q);
}
SEXTANT_INLINE Vec4d SumFours(const Vec4d& p, const Vec4d& q) {
  return FirstOfFours(p, q) + LastOfFours(p, q);
}
SEXTANT_INLINE Vec4d SumQuarters(const Vec4d& p, const Vec4d& q, const Vec4d& r, const Vec4d& s) {
  return SumFours(SumPairs(p, q), SumPairs(r, s));
}
SEXTANT_INLINE SplitVec8d SumEach(const SplitVec8d& a, const SplitVec8d& b, const SplitVec8d& c,
                                  const SplitVec8d& d, const SplitVec8d& e, const SplitVec8d& f,
                                  const SplitVec8d& g, const SplitVec8d& h) {
  return {SumQuarters(a.low, b.low, c.low, d.low) + SumQuarters(a.high, b.high, c.high, d.high),
          SumQuarters(e.low, f.low, g.low, h.low) + SumQuarters(e.high, f.high, g.high, h.high)};
}

SEXTANT_INLINE bool AnyTrue(const SplitMask8& mask) {
  const Mask4 any = mask.low | mask.high;
  return ((any[0] | any[1]) | (any[2] | any[3])) != 0;
}

}  // namespace sextant
