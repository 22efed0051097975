// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/calibration_problem.h"
#include "solvers/horn_matrix.h"

namespace sextant {

/// Points in lanes: of one pair (Real = double) or of eight (Lanes).

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

/// Eight points from x y z x y z ..., seen from `o`, in an order of its own: kPointOrder. A position
/// holds x of one of the three registers only, so that blends sort the coordinates; y and z then
/// stand one and two places off.
SEXTANT_INLINE Point3<Lanes> LoadPoints(const double* from, const Point3<double>& o) {
  // Each register is read once: differences are never read anew, as loads are.
  const Lanes p = LoadLanes(from) - Lanes{o.x, o.y, o.z, o.x, o.y, o.z, o.x, o.y};
  const Lanes q = LoadLanes(from + kLanes) - Lanes{o.z, o.x, o.y, o.z, o.x, o.y, o.z, o.x};
  const Lanes r = LoadLanes(from + 2 * kLanes) - Lanes{o.y, o.z, o.x, o.y, o.z, o.x, o.y, o.z};
  // Choices between two by constant places: by a constant mask g++ 12 takes them apart.
  const Lanes x = __builtin_shufflevector(__builtin_shufflevector(p, q, 0, 9, 2, 3, 12, 5, 6, 15),
                                          r, 0, 1, 10, 3, 4, 13, 6, 7);
  const Lanes y = __builtin_shufflevector(__builtin_shufflevector(p, q, 0, 1, 10, 3, 4, 13, 6, 7),
                                          r, 8, 1, 2, 11, 4, 5, 14, 7);
  const Lanes z = __builtin_shufflevector(__builtin_shufflevector(p, q, 8, 1, 2, 11, 4, 5, 14, 7),
                                          r, 0, 9, 2, 3, 12, 5, 6, 15);
  return {x, __builtin_shufflevector(y, y, 1, 2, 3, 4, 5, 6, 7, 0),
          __builtin_shufflevector(z, z, 2, 3, 4, 5, 6, 7, 0, 1)};
}
inline constexpr LaneMask kPointOrder = {0, 3, 6, 1, 4, 7, 2, 5};

/// A coordinate of eight pairs.
SEXTANT_INLINE Lanes Gather(const Pair3d3d* p, Eigen::Vector3d Pair3d3d::*point, int axis) {
  return Lanes{(p[0].*point)[axis], (p[1].*point)[axis], (p[2].*point)[axis], (p[3].*point)[axis],
               (p[4].*point)[axis], (p[5].*point)[axis], (p[6].*point)[axis], (p[7].*point)[axis]};
}
SEXTANT_INLINE Point3<Lanes> Gather(const Pair3d3d* p, Eigen::Vector3d Pair3d3d::*point) {
  return {Gather(p, point, 0), Gather(p, point, 1), Gather(p, point, 2)};
}

}  // namespace sextant
