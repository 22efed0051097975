// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <type_traits>

#include "base/lanes.h"

/// Defines a function from its template of the lanes, `name`For, which each machine gets with those
/// that it computes on best; one, where the build is for one machine. The template and what it
/// calls must be SEXTANT_INLINE. It asks the processor at each call, by one load and a branch that
/// is always the same: the loader's choice would be as fast, but clang 14 then leaves out inline
/// functions that only its versions call, and sanitizers cannot run it.
// NOLINTBEGIN(bugprone-macro-parentheses): types and parameter lists bear none.
#if defined(__AVX512F__)
#define SEXTANT_FOR_LANES(Return, name, parameters, arguments) \
  Return name parameters { return name##For<Lanes> arguments; }
#elif defined(__x86_64__) && defined(__GNUC__) && !defined(__AVX2__)
#define SEXTANT_FOR_LANES(Return, name, parameters, arguments)            \
  __attribute__((target("avx2"))) Return name##Avx2 parameters {          \
    return name##For<SplitLanes> arguments;                               \
  }                                                                       \
  __attribute__((target("avx512f"))) Return name##Avx512 parameters {     \
    return name##For<Lanes> arguments;                                    \
  }                                                                       \
  Return name parameters {                                                \
    if (__builtin_cpu_supports("avx512f")) return name##Avx512 arguments; \
    if (__builtin_cpu_supports("avx2")) return name##Avx2 arguments;      \
    return name##For<SplitLanes> arguments;                               \
  }
#else
#define SEXTANT_FOR_LANES(Return, name, parameters, arguments) \
  Return name parameters { return name##For<SplitLanes> arguments; }
#endif
// NOLINTEND(bugprone-macro-parentheses)

namespace sextant {

using FourLanes = double __attribute__((vector_size(32)));
using FourMask = long long __attribute__((vector_size(32)));

/// LaneMask as two halves.
struct SplitMask {
  FourMask low, high;
};

/// Lanes as two registers of four, for machines whose registers are no wider: there g++ 12 takes
/// comparisons, choices and shuffles of Lanes apart into scalars. Every operation rounds as that of
/// Lanes does.
struct SplitLanes {
  SEXTANT_INLINE double operator[](std::size_t i) const { return i < 4 ? low[i] : high[i - 4]; }

  FourLanes low, high;
};

#define SEXTANT_SPLIT_ARITHMETIC(op)                                                \
  SEXTANT_INLINE SplitLanes operator op(const SplitLanes& a, const SplitLanes& b) { \
    return {a.low op b.low, a.high op b.high};                                      \
  }                                                                                 \
  SEXTANT_INLINE SplitLanes operator op(const SplitLanes& a, double b) {            \
    return {a.low op b, a.high op b};                                               \
  }                                                                                 \
  SEXTANT_INLINE SplitLanes operator op(double a, const SplitLanes& b) {            \
    return {a op b.low, a op b.high};                                               \
  }
SEXTANT_SPLIT_ARITHMETIC(+)
SEXTANT_SPLIT_ARITHMETIC(-)
SEXTANT_SPLIT_ARITHMETIC(*)
SEXTANT_SPLIT_ARITHMETIC(/)
#undef SEXTANT_SPLIT_ARITHMETIC

#define SEXTANT_SPLIT_COMPARISON(op)                                               \
  SEXTANT_INLINE SplitMask operator op(const SplitLanes& a, const SplitLanes& b) { \
    return {a.low op b.low, a.high op b.high};                                     \
  }                                                                                \
  SEXTANT_INLINE SplitMask operator op(const SplitLanes& a, double b) {            \
    return {a.low op b, a.high op b};                                              \
  }
SEXTANT_SPLIT_COMPARISON(<)
SEXTANT_SPLIT_COMPARISON(<=)
SEXTANT_SPLIT_COMPARISON(>)
#undef SEXTANT_SPLIT_COMPARISON

SEXTANT_INLINE SplitLanes operator-(const SplitLanes& a) { return {-a.low, -a.high}; }
SEXTANT_INLINE SplitLanes& operator+=(SplitLanes& a, const SplitLanes& b) { return a = a + b; }
SEXTANT_INLINE SplitLanes& operator-=(SplitLanes& a, const SplitLanes& b) { return a = a - b; }

SEXTANT_INLINE SplitMask operator>=(const SplitMask& a, long long b) {
  return {a.low >= b, a.high >= b};
}
SEXTANT_INLINE SplitMask operator~(const SplitMask& a) { return {~a.low, ~a.high}; }
SEXTANT_INLINE SplitMask operator&(const SplitMask& a, const SplitMask& b) {
  return {a.low & b.low, a.high & b.high};
}
SEXTANT_INLINE SplitMask operator|(const SplitMask& a, const SplitMask& b) {
  return {a.low | b.low, a.high | b.high};
}
SEXTANT_INLINE SplitMask& operator&=(SplitMask& a, const SplitMask& b) { return a = a & b; }
SEXTANT_INLINE SplitMask& operator|=(SplitMask& a, const SplitMask& b) { return a = a | b; }

/// What a comparison of L gives.
template <class L>
using MaskOf = std::conditional_t<std::is_same_v<L, Lanes>, LaneMask, SplitMask>;

/// Zero where the mask does not hold, whatever is there.
SEXTANT_INLINE Lanes Keep(const LaneMask& mask, const Lanes& lanes) {
  return reinterpret_cast<Lanes>(mask & reinterpret_cast<LaneMask>(lanes));
}
SEXTANT_INLINE SplitLanes Keep(const SplitMask& mask, const SplitLanes& lanes) {
  return {reinterpret_cast<FourLanes>(mask.low & reinterpret_cast<FourMask>(lanes.low)),
          reinterpret_cast<FourLanes>(mask.high & reinterpret_cast<FourMask>(lanes.high))};
}

/// `mask ? a : b`, for what is written once for doubles and both kinds of lanes.
SEXTANT_INLINE double Select(bool mask, double a, double b) { return mask ? a : b; }
template <class Mask>
SEXTANT_INLINE Lanes Select(const Mask& mask, const Lanes& a, const Lanes& b) {
  return mask ? a : b;
}
SEXTANT_INLINE SplitLanes Select(const SplitMask& mask, const SplitLanes& a, const SplitLanes& b) {
  return {mask.low ? a.low : b.low, mask.high ? a.high : b.high};
}

SEXTANT_INLINE SplitLanes Sqrt(const SplitLanes& a) {
  SplitLanes roots;
  for (std::size_t i = 0; i < 4; ++i) roots.low[i] = std::sqrt(a.low[i]);
  for (std::size_t i = 0; i < 4; ++i) roots.high[i] = std::sqrt(a.high[i]);
  return roots;
}
SEXTANT_INLINE SplitLanes Abs(const SplitLanes& a) { return Select(a < 0.0, -a, a); }
SEXTANT_INLINE SplitLanes Min(const SplitLanes& a, const SplitLanes& b) {
  return Select(b < a, b, a);
}
SEXTANT_INLINE SplitLanes Max(const SplitLanes& a, const SplitLanes& b) {
  return Select(a < b, b, a);
}

/// Eight numbers: doubles to lanes, whole numbers to a mask.
template <class L, class Number>
SEXTANT_INLINE L LanesOf(Number a, Number b, Number c, Number d, Number e, Number f, Number g,
                         Number h) {
  if constexpr (std::is_class_v<L>) {
    using Half = decltype(L::low);
    return {Half{a, b, c, d}, Half{e, f, g, h}};
  } else {
    const L lanes = {a, b, c, d, e, f, g, h};
    return lanes;
  }
}

/// One number in all lanes.
template <class L>
SEXTANT_INLINE L All(double value) {
  return value - L{};
}

/// Eight doubles from any address. Half by half: a copy of the whole would go by memory.
template <class L>
SEXTANT_INLINE L Load(const double* from) {
  if constexpr (std::is_class_v<L>) {
    L lanes;
    std::memcpy(&lanes.low, from, sizeof lanes.low);
    std::memcpy(&lanes.high, from + 4, sizeof lanes.high);
    return lanes;
  } else {
    return LoadLanes(from);
  }
}
SEXTANT_INLINE void StoreLanes(const SplitLanes& lanes, double* to) {
  std::memcpy(to, &lanes.low, sizeof lanes.low);
  std::memcpy(to + 4, &lanes.high, sizeof lanes.high);
}

template <class Mask>
SEXTANT_INLINE void StoreMask(const Mask& mask, long long* to) {
  std::memcpy(to, &mask, sizeof mask);
}

SEXTANT_INLINE double SumLanes(const SplitLanes& lanes) {
  using Two = double __attribute__((vector_size(16)));
  const FourLanes four = lanes.low + lanes.high;
  const Two two =
      __builtin_shufflevector(four, four, 0, 1) + __builtin_shufflevector(four, four, 2, 3);
  return two[0] + two[1];
}

SEXTANT_INLINE FourLanes FirstOfTwos(const FourLanes& p, const FourLanes& q) {
  return __builtin_shufflevector(p, q, 0, 4, 2, 6);
}
SEXTANT_INLINE FourLanes LastOfTwos(const FourLanes& p, const FourLanes& q) {
  return __builtin_shufflevector(p, q, 1, 5, 3, 7);
}
SEXTANT_INLINE FourLanes FirstOfFours(const FourLanes& p, const FourLanes& q) {
  return __builtin_shufflevector(p, q, 0, 1, 4, 5);
}
SEXTANT_INLINE FourLanes LastOfFours(const FourLanes& p, const FourLanes& q) {
  return __builtin_shufflevector(p, q, 2, 3, 6, 7);
}
#define SEXTANT_SPLIT_SHUFFLE(name)                                          \
  SEXTANT_INLINE SplitLanes name(const SplitLanes& p, const SplitLanes& q) { \
    return {name(p.low, q.low), name(p.high, q.high)};                       \
  }
SEXTANT_SPLIT_SHUFFLE(FirstOfTwos)
SEXTANT_SPLIT_SHUFFLE(LastOfTwos)
SEXTANT_SPLIT_SHUFFLE(FirstOfFours)
SEXTANT_SPLIT_SHUFFLE(LastOfFours)
#undef SEXTANT_SPLIT_SHUFFLE
SEXTANT_INLINE SplitLanes FirstOfEight(const SplitLanes& p, const SplitLanes& q) {
  return {p.low, q.low};
}
SEXTANT_INLINE SplitLanes LastOfEight(const SplitLanes& p, const SplitLanes& q) {
  return {p.high, q.high};
}

SEXTANT_INLINE FourLanes SumPairs(const FourLanes& p, const FourLanes& q) {
  return FirstOfTwos(p, q) + LastOfTwos(p, q);
}
SEXTANT_INLINE FourLanes SumFours(const FourLanes& p, const FourLanes& q) {
  return FirstOfFours(p, q) + LastOfFours(p, q);
}
SEXTANT_INLINE FourLanes SumQuarters(const FourLanes& p, const FourLanes& q, const FourLanes& r,
                                     const FourLanes& s) {
  return SumFours(SumPairs(p, q), SumPairs(r, s));
}
SEXTANT_INLINE SplitLanes SumEach(const SplitLanes& a, const SplitLanes& b, const SplitLanes& c,
                                  const SplitLanes& d, const SplitLanes& e, const SplitLanes& f,
                                  const SplitLanes& g, const SplitLanes& h) {
  return {SumQuarters(a.low, b.low, c.low, d.low) + SumQuarters(a.high, b.high, c.high, d.high),
          SumQuarters(e.low, f.low, g.low, h.low) + SumQuarters(e.high, f.high, g.high, h.high)};
}

SEXTANT_INLINE bool AnyLane(const SplitMask& mask) {
  const FourMask any = mask.low | mask.high;
  return ((any[0] | any[1]) | (any[2] | any[3])) != 0;
}

}  // namespace sextant
