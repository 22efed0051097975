// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/calibration_problem.h"
#include "solvers/kernels/horn_matrix.h"

namespace sextant {

/// Points in lanes: of one pair (Real = double) or of eight (L = Vec8d or SplitVec8d).

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

/// a b c a b c ..., each from its own place.
SEXTANT_INLINE Vec4d InTurn(const Vec4d& a, const Vec4d& b, const Vec4d& c) {
  return __builtin_shufflevector(__builtin_shufflevector(a, b, 0, 5, 2, 3), c, 0, 1, 6, 3);
}
SEXTANT_INLINE SplitVec8d InTurn(const SplitVec8d& a, const SplitVec8d& b, const SplitVec8d& c) {
  return {InTurn(a.low, b.low, c.low), InTurn(b.high, c.high, a.high)};
}
SEXTANT_INLINE Vec8d InTurn(const Vec8d& a, const Vec8d& b, const Vec8d& c) {
  // By a constant mask g++ 12 takes choices apart.
  return __builtin_shufflevector(__builtin_shufflevector(a, b, 0, 9, 2, 3, 12, 5, 6, 15), c, 0, 1,
                                 10, 3, 4, 13, 6, 7);
}

/// Every lane from so many places on, the first ones last.
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
template <class L>
struct RepeatedPoint {
  SEXTANT_INLINE explicit RepeatedPoint(const Point3<double>& o)
      : RepeatedPoint(All<L>(o.x), All<L>(o.y), All<L>(o.z)) {}
  SEXTANT_INLINE RepeatedPoint(const L& x, const L& y, const L& z)
      : first(InTurn(x, y, z)), second(InTurn(z, x, y)), third(InTurn(y, z, x)) {}

  L first, second, third;
};

/// Eight points from x y z x y z ..., seen from an origin, in an order of its own: kPointOrder. A
/// place holds x of one of the three registers only, so that choices sort the coordinates; y and z
/// then stand one and two places off.
template <class L>
SEXTANT_INLINE Point3<L> LoadPoints(const double* from, const RepeatedPoint<L>& origin) {
  // Each register is read once: unlike loads, differences are never made anew.
  const L p = Load<L>(from) - origin.first;
  const L q = Load<L>(from + kSimdWidth) - origin.second;
  const L r = Load<L>(from + 2 * kSimdWidth) - origin.third;
  return {InTurn(p, q, r), Turned<1>(InTurn(r, p, q)), Turned<2>(InTurn(q, r, p))};
}
inline constexpr std::size_t kPointOrder[kSimdWidth] = {0, 3, 6, 1, 4, 7, 2, 5};

/// A coordinate of eight pairs.
template <class L>
SEXTANT_INLINE L Gather(const Pair3d3d* p, Eigen::Vector3d Pair3d3d::*point, int axis) {
  return VecOf<L>((p[0].*point)[axis], (p[1].*point)[axis], (p[2].*point)[axis],
                  (p[3].*point)[axis], (p[4].*point)[axis], (p[5].*point)[axis],
                  (p[6].*point)[axis], (p[7].*point)[axis]);
}
template <class L>
SEXTANT_INLINE Point3<L> Gather(const Pair3d3d* p, Eigen::Vector3d Pair3d3d::*point) {
  return {Gather<L>(p, point, 0), Gather<L>(p, point, 1), Gather<L>(p, point, 2)};
}

}  // namespace sextant
