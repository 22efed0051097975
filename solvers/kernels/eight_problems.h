// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "base/simd.h"

namespace sextant::p3p {

/// Arithmetic that is written once for one problem (double), for the four candidates of one problem
/// (Vec4d) and for eight problems (Vec8d): selections in place of branches.

using Vec4d = double __attribute__((vector_size(32)));

SEXTANT_INLINE double Select(bool mask, double a, double b) { return mask ? a : b; }
template <class Mask>
SEXTANT_INLINE Vec4d Select(const Mask& mask, const Vec4d& a, const Vec4d& b) {
  return mask ? a : b;
}
template <class Mask>
SEXTANT_INLINE Vec8d Select(const Mask& mask, const Vec8d& a, const Vec8d& b) {
  return mask ? a : b;
}

SEXTANT_INLINE bool Any(bool mask) { return mask; }
template <class Mask>
SEXTANT_INLINE bool Any(const Mask& mask) {
  auto any = mask[0];
  for (std::size_t i = 1; i < sizeof mask / sizeof any; ++i) any |= mask[i];
  return any != 0;
}

SEXTANT_INLINE double SquareRoot(double a) { return std::sqrt(a); }
SEXTANT_INLINE Vec4d SquareRoot(const Vec4d& a) {
  return Vec4d{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
}
SEXTANT_INLINE Vec8d SquareRoot(const Vec8d& a) { return Sqrt(a); }

template <class T>
SEXTANT_INLINE T Size(const T& a) {
  return Select(a < 0.0, -a, a);
}
template <class T>
SEXTANT_INLINE T Larger(const T& a, const T& b) {
  return Select(a < b, b, a);
}
template <class T>
SEXTANT_INLINE T AtLeastZero(const T& a) {
  return Select(a > 0.0, a, T{});
}

SEXTANT_INLINE void BitsOf(double a, std::int64_t& bits) { std::memcpy(&bits, &a, sizeof a); }
SEXTANT_INLINE void BitsOf(const Vec8d& a, Mask8& bits) { std::memcpy(&bits, &a, sizeof a); }
template <class T>
struct Bits;
template <>
struct Bits<double> {
  using Type = std::int64_t;
};
template <>
struct Bits<Vec8d> {
  using Type = Mask8;
};

/// Within 1e-4 of the cube root of a positive number: a third of the exponent, then Halley's step.
template <class T>
SEXTANT_INLINE T RoughCubeRoot(const T& a) {
  using Whole = typename Bits<T>::Type;
  // 1/4 + 1/16 + ...; the offset makes the root of 1 equal 1.
  const auto third = [](const auto& i) __attribute__((always_inline)) {
    return (i >> 2) + (i >> 4) + (i >> 6) + (i >> 8) + (i >> 10) + (i >> 12);
  };
  constexpr std::int64_t kOne = 0x3ff0000000000000;
  const std::int64_t offset = kOne - third(kOne);
  Whole bits;
  BitsOf(a, bits);
  const Whole root_bits = third(bits) + offset;
  T root;
  std::memcpy(&root, &root_bits, sizeof root);
  for (int i = 0; i < 2; ++i) {
    const T cube = root * root * root;
    root = root * (cube + 2.0 * a) / (2.0 * cube + a);
  }
  return root;
}

template <class T>
struct Vector {
  T x, y, z;
};

template <class T>
SEXTANT_INLINE Vector<T> operator-(const Vector<T>& a, const Vector<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
SEXTANT_INLINE Vector<T> operator*(const T& s, const Vector<T>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class T>
SEXTANT_INLINE T Dot(const Vector<T>& a, const Vector<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
SEXTANT_INLINE Vector<T> Cross(const Vector<T>& a, const Vector<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T, class Mask>
SEXTANT_INLINE Vector<T> Select(const Mask& mask, const Vector<T>& a, const Vector<T>& b) {
  return {Select(mask, a.x, b.x), Select(mask, a.y, b.y), Select(mask, a.z, b.z)};
}

}  // namespace sextant::p3p
