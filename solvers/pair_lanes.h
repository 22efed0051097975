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

/// Eight points from x y z x y z ..., in an order of its own: kPointOrder. A position holds x of
/// one of the three registers only, so that blends sort the coordinates; y and z then stand one
/// and two places off.
SEXTANT_INLINE Point3<Lanes> LoadPoints(const double* from) {
  const Lanes p = LoadLanes(from);
  const Lanes q = LoadLanes(from + kLanes);
  const Lanes r = LoadLanes(from + 2 * kLanes);
  const LaneMask is_first = {-1, 0, 0, -1, 0, 0, -1, 0};
  const LaneMask is_second = {0, -1, 0, 0, -1, 0, 0, -1};
  const LaneMask is_third = {0, 0, -1, 0, 0, -1, 0, 0};
  const Lanes x = is_first ? p : (is_second ? q : r);
  const Lanes y = is_second ? p : (is_third ? q : r);
  const Lanes z = is_third ? p : (is_first ? q : r);
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
