// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/calibration_problem.h"
#include "solvers/kernels/horn_matrix.h"

namespace sextant {

/// A point (Real = double), or eight points coordinate by coordinate (V = Vec8d or SplitVec8d).

template <class Real>
struct Point3 {
  Real x, y, z;
};

SEXTANT_INLINE Point3<double> PointAt(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

template <class Real, class Origin>
SEXTANT_INLINE Point3<Real> operator-(const Point3<Real>& p, const Point3<Origin>& origin) {
  return {p.x - origin.x, p.y - origin.y, p.z - origin.z};
}

template <class Real>
SEXTANT_INLINE Point3<Real> Rotate(const RotationMatrix<Real>& r, const Point3<Real>& p) {
  return {r.xx * p.x + r.xy * p.y + r.xz * p.z, r.yx * p.x + r.yy * p.y + r.yz * p.z,
          r.zx * p.x + r.zy * p.y + r.zz * p.z};
}

/// a b c a b c ..., each element from its own position.
SEXTANT_INLINE Vec4d InTurn(const Vec4d& a, const Vec4d& b, const Vec4d& c) {
  return __builtin_shufflevector(__builtin_shufflevector(a, b, 0, 5, 2, 3), c, 0, 1, 6, 3);
}
SEXTANT_INLINE SplitVec8d InTurn(const SplitVec8d& a, const SplitVec8d& b, const SplitVec8d& c) {
  return {InTurn(a.low, b.low, c.low), InTurn(b.high, c.high, a.high)};
}
SEXTANT_INLINE Vec8d InTurn(const Vec8d& a, const Vec8d& b, const Vec8d& c) {
  // g++ 12 breaks selections by a constant mask into scalars.
  return __builtin_shufflevector(__builtin_shufflevector(a, b, 0, 9, 2, 3, 12, 5, 6, 15), c, 0, 1,
                                 10, 3, 4, 13, 6, 7);
}

/// Rotated by kBy elements towards the front.
template <int kBy>
SEXTANT_INLINE Vec8d Turned(const Vec8d& a) {
  return __builtin_shufflevector(a, a, kBy, kBy + 1, kBy + 2, kBy + 3, kBy + 4, kBy + 5, kBy + 6,
                                 kBy + 7);
}
template <int kBy>
SEXTANT_INLINE SplitVec8d Turned(const SplitVec8d& a) {
  return {__builtin_shufflevector(a.low, a.high, kBy, kBy + 1, kBy + 2, kBy + 3),
          __builtin_shufflevector(a.high, a.low, kBy, kBy + 1, kBy + 2, kBy + 3)};
}

/// A point as three registers of x y z x y z ...
template <class V>
struct RepeatedPoint {
  SEXTANT_INLINE explicit RepeatedPoint(const Point3<double>& o)
      : RepeatedPoint(All<V>(o.x), All<V>(o.y), All<V>(o.z)) {}
  SEXTANT_INLINE RepeatedPoint(const V& x, const V& y, const V& z)
      : first(InTurn(x, y, z)), second(InTurn(z, x, y)), third(InTurn(y, z, x)) {}

  V first, second, third;
};

/// Eight points from x y z x y z ..., relative to an origin, in the order kPointOrder. At each
/// position only one of the three registers holds an x, so that selections sort the coordinates; y
/// and z are then one and two positions off.
template <class V>
SEXTANT_INLINE Point3<V> LoadPoints(const double* from, const RepeatedPoint<V>& origin) {
  // The differences keep g++ from loading each register three times.
  const V p = Load<V>(from) - origin.first;
  const V q = Load<V>(from + kSimdWidth) - origin.second;
  const V r = Load<V>(from + 2 * kSimdWidth) - origin.third;
  return {InTurn(p, q, r), Turned<1>(InTurn(r, p, q)), Turned<2>(InTurn(q, r, p))};
}
inline constexpr std::size_t kPointOrder[kSimdWidth] = {0, 3, 6, 1, 4, 7, 2, 5};

/// A coordinate of eight pairs.
template <class V>
SEXTANT_INLINE V Gather(const Pair3d3d* p, Eigen::Vector3d Pair3d3d::*point, int axis) {
  return VecOf<V>((p[0].*point)[axis], (p[1].*point)[axis], (p[2].*point)[axis],
                  (p[3].*point)[axis], (p[4].*point)[axis], (p[5].*point)[axis],
                  (p[6].*point)[axis], (p[7].*point)[axis]);
}
template <class V>
SEXTANT_INLINE Point3<V> Gather(const Pair3d3d* p, Eigen::Vector3d Pair3d3d::*point) {
  return {Gather<V>(p, point, 0), Gather<V>(p, point, 1), Gather<V>(p, point, 2)};
}

}  // namespace sextant
