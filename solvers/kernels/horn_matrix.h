// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "solvers/kernels/simd_dispatch.h"

namespace sextant {

/// The algebra of Wahba's problem without branches. Inlined, so that it is compiled for the
/// instruction set of its caller.

SEXTANT_INLINE double Sqrt(double x) { return std::sqrt(x); }
SEXTANT_INLINE double Abs(double x) { return std::abs(x); }
SEXTANT_INLINE double Min(double a, double b) { return b < a ? b : a; }
SEXTANT_INLINE double Max(double a, double b) { return a < b ? b : a; }

/// sum w a b^T, its rows along a.
template <class Real>
struct CrossMatrix {
  Real xx, xy, xz, yx, yy, yz, zx, zy, zz;
};

/// Horn's symmetric 4x4 matrix: q^T K q = trace(R(q) * cross) for q = (x, y, z, w). Named scalars
/// stay in registers, whereas a matrix would be stored and loaded again.
template <class Real>
struct HornMatrix {
  Real xx, yy, zz, ww, xy, xz, yz, xw, yw, zw;
};

template <class Real>
SEXTANT_INLINE HornMatrix<Real> MakeHornMatrix(const CrossMatrix<Real>& m) {
  return {m.xx - m.yy - m.zz, m.yy - m.xx - m.zz, m.zz - m.xx - m.yy, m.xx + m.yy + m.zz,
          m.xy + m.yx,        m.xz + m.zx,        m.yz + m.zy,        m.yz - m.zy,
          m.zx - m.xz,        m.xy - m.yx};
}

/// Symmetric functions of the signed singular values of cross, which need no SVD.
template <class Real>
struct Invariants {
  Real sum_squares;   // s1^2 + s2^2 + s3^2
  Real pair_squares;  // (s1 s2)^2 + (s1 s3)^2 + (s2 s3)^2
  Real product;       // s1 s2 s3
};

template <class Real>
SEXTANT_INLINE Invariants<Real> ComputeInvariants(const CrossMatrix<Real>& m) {
  const Real c00 = m.yy * m.zz - m.yz * m.zy;
  const Real c01 = m.yz * m.zx - m.yx * m.zz;
  const Real c02 = m.yx * m.zy - m.yy * m.zx;
  const Real c10 = m.xz * m.zy - m.xy * m.zz;
  const Real c11 = m.xx * m.zz - m.xz * m.zx;
  const Real c12 = m.xy * m.zx - m.xx * m.zy;
  const Real c20 = m.xy * m.yz - m.xz * m.yy;
  const Real c21 = m.xz * m.yx - m.xx * m.yz;
  const Real c22 = m.xx * m.yy - m.xy * m.yx;
  return {m.xx * m.xx + m.xy * m.xy + m.xz * m.xz + (m.yx * m.yx + m.yy * m.yy + m.yz * m.yz) +
              (m.zx * m.zx + m.zy * m.zy + m.zz * m.zz),
          c00 * c00 + c01 * c01 + c02 * c02 + (c10 * c10 + c11 * c11 + c12 * c12) +
              (c20 * c20 + c21 * c21 + c22 * c22),
          m.xx * c00 + m.xy * c01 + m.xz * c02};
}

/// The characteristic polynomial of K: x^4 + c2 x^2 + c1 x + c0.
template <class Real>
struct Quartic {
  Real c2, c1, c0;
};

template <class Real>
SEXTANT_INLINE Quartic<Real> CharacteristicPolynomial(const Invariants<Real>& v) {
  return {-2.0 * v.sum_squares, -8.0 * v.product,
          v.sum_squares * v.sum_squares - 4.0 * v.pair_squares};
}

/// Householder's step of third order: the error becomes its fourth power. On a polynomial with real
/// roots it does not overshoot from beyond the outermost root: with d = 3 the difference is minus a
/// divided difference of (x - r)^-(d + 1) over the other roots r.
template <class Real>
SEXTANT_INLINE Real HouseholderStep(const Quartic<Real>& p, const Real& x) {
  const Real square = x * x;
  const Real value = (square + p.c2) * square + (p.c1 * x + p.c0);
  const Real slope = 4.0 * x * square + (2.0 * p.c2 * x + p.c1);
  const Real half_curvature = 6.0 * square + p.c2;
  const Real a = slope * slope;
  const Real b = value * half_curvature;
  return value * (a - b) / (slope * (a - 2.0 * b) + 4.0 * x * (value * value));
}

template <class Real>
struct Vector4 {
  Real x, y, z, w;
};

template <class Mask, class Real>
SEXTANT_INLINE Vector4<Real> Select(const Mask& first, const Vector4<Real>& a,
                                    const Vector4<Real>& b) {
  return {Select(first, a.x, b.x), Select(first, a.y, b.y), Select(first, a.z, b.z),
          Select(first, a.w, b.w)};
}

/// A null vector of K - shift I, of rank 3: the largest column of its adjugate.
template <class Real>
SEXTANT_INLINE Vector4<Real> NullVector(const HornMatrix<Real>& k, const Real& shift) {
  const Real xx = k.xx - shift;
  const Real yy = k.yy - shift;
  const Real zz = k.zz - shift;
  const Real ww = k.ww - shift;
  // 2x2 minors of the rows (x, y) and of the rows (z, w), named by their columns.
  const Real xy_xy = xx * yy - k.xy * k.xy;
  const Real xy_xz = xx * k.yz - k.xz * k.xy;
  const Real xy_xw = xx * k.yw - k.xw * k.xy;
  const Real xy_yz = k.xy * k.yz - k.xz * yy;
  const Real xy_yw = k.xy * k.yw - k.xw * yy;
  const Real xy_zw = k.xz * k.yw - k.xw * k.yz;
  const Real zw_xz = k.xz * k.zw - zz * k.xw;
  const Real zw_xw = k.xz * ww - k.zw * k.xw;
  const Real zw_yz = k.yz * k.zw - zz * k.yw;
  const Real zw_yw = k.yz * ww - k.zw * k.yw;
  const Real zw_zw = zz * ww - k.zw * k.zw;

  const Real adj_xx = yy * zw_zw - k.yz * zw_yw + k.yw * zw_yz;
  const Real adj_yy = xx * zw_zw - k.xz * zw_xw + k.xw * zw_xz;
  const Real adj_zz = k.xw * xy_yw - k.yw * xy_xw + ww * xy_xy;
  const Real adj_ww = k.xz * xy_yz - k.yz * xy_xz + zz * xy_xy;
  const Real adj_xy = k.xz * zw_yw - k.xy * zw_zw - k.xw * zw_yz;
  const Real adj_xz = k.yw * xy_zw - k.zw * xy_yw + ww * xy_yz;
  const Real adj_xw = zz * xy_yw - k.zw * xy_yz - k.yz * xy_zw;
  const Real adj_yz = k.zw * xy_xw - k.xw * xy_zw - ww * xy_xz;
  const Real adj_yw = k.xz * xy_zw + k.zw * xy_xz - zz * xy_xw;
  const Real adj_zw = k.yz * xy_xw - k.xz * xy_yw - k.zw * xy_xy;

  // The adjugate is a negative multiple of q q^T: the most negative of the diagonal is the largest.
  const Vector4<Real> xy = Select(adj_xx < adj_yy, Vector4<Real>{adj_xx, adj_xy, adj_xz, adj_xw},
                                  Vector4<Real>{adj_xy, adj_yy, adj_yz, adj_yw});
  const Vector4<Real> zw = Select(adj_zz < adj_ww, Vector4<Real>{adj_xz, adj_yz, adj_zz, adj_zw},
                                  Vector4<Real>{adj_xw, adj_yw, adj_zw, adj_ww});
  return Select(Min(adj_xx, adj_yy) < Min(adj_zz, adj_ww), xy, zw);
}

/// The distance of a vector from the eigenvector of an eigenvalue.
template <class Real>
struct EigenResidual {
  Vector4<Real> residual;  // K q - value q
  Real residual2;          // Its squared length.
  Real length2;            // |q|^2
  Real shift;              // The Rayleigh quotient minus the value.
};

template <class Real>
SEXTANT_INLINE EigenResidual<Real> ResidualOf(const HornMatrix<Real>& k, const Real& value,
                                              const Vector4<Real>& q) {
  const Real x = (k.xx - value) * q.x + k.xy * q.y + (k.xz * q.z + k.xw * q.w);
  const Real y = k.xy * q.x + (k.yy - value) * q.y + (k.yz * q.z + k.yw * q.w);
  const Real z = k.xz * q.x + k.yz * q.y + ((k.zz - value) * q.z + k.zw * q.w);
  const Real w = k.xw * q.x + k.yw * q.y + (k.zw * q.z + (k.ww - value) * q.w);
  const Real length2 = q.x * q.x + q.y * q.y + (q.z * q.z + q.w * q.w);
  return {{x, y, z, w},
          x * x + y * y + (z * z + w * w),
          length2,
          (q.x * x + q.y * y + (q.z * z + q.w * w)) / length2};
}

/// Where s1 is far above the others, rounding of the adjugate leaves components along the two
/// eigenvectors whose eigenvalues are about 2 s1 lower. The residual at the Rayleigh quotient
/// `value` shows them, and they are subtracted.
template <class Real>
SEXTANT_INLINE Vector4<Real> WithoutFarParts(const Vector4<Real>& q, const EigenResidual<Real>& r,
                                             const Real& value) {
  const Real scale = 0.5 / value;
  const Real own = 1.0 - scale * r.shift;
  return {own * q.x + scale * r.residual.x, own * q.y + scale * r.residual.y,
          own * q.z + scale * r.residual.z, own * q.w + scale * r.residual.w};
}

template <class Real>
struct RotationMatrix {
  Real xx, xy, xz, yx, yy, yz, zx, zy, zz;
};

/// The rotation of a unit quaternion.
template <class Real>
SEXTANT_INLINE RotationMatrix<Real> MakeRotationMatrix(const Vector4<Real>& q) {
  const Real x2 = q.x + q.x;
  const Real y2 = q.y + q.y;
  const Real z2 = q.z + q.z;
  const Real wx = x2 * q.w;
  const Real wy = y2 * q.w;
  const Real wz = z2 * q.w;
  const Real xx = x2 * q.x;
  const Real xy = y2 * q.x;
  const Real xz = z2 * q.x;
  const Real yy = y2 * q.y;
  const Real yz = z2 * q.y;
  const Real zz = z2 * q.z;
  return {1.0 - (yy + zz), xy - wz, xz + wy, xy + wz,        1.0 - (xx + zz),
          yz - wx,         xz - wy, yz + wx, 1.0 - (xx + yy)};
}

/// The smallest eigenvalue of the symmetric matrix R * cross, the signed s3: to 1e-8 of the largest
/// where s2 equals it, and to rounding where all three differ.
///
/// Minus its mean eigenvalue q the matrix is p times one whose eigenvalues m solve
/// m^3 - 3 m = 2 r, |r| <= 1. The one with the largest magnitude, in [sqrt(3), 2], is a single
/// root: a parabola in |r| gives three digits, two of Halley's steps the rest; the other two follow
/// (Smith 1961, CACM 4).
template <class Real>
SEXTANT_INLINE Real SmallestSingularValue(const RotationMatrix<Real>& r,
                                          const CrossMatrix<Real>& m) {
  const Real xx = r.xx * m.xx + r.xy * m.yx + r.xz * m.zx;
  const Real yy = r.yx * m.xy + r.yy * m.yy + r.yz * m.zy;
  const Real zz = r.zx * m.xz + r.zy * m.yz + r.zz * m.zz;
  const Real xy = r.xx * m.xy + r.xy * m.yy + r.xz * m.zy;
  const Real xz = r.xx * m.xz + r.xy * m.yz + r.xz * m.zz;
  const Real yz = r.yx * m.xz + r.yy * m.yz + r.yz * m.zz;
  const Real mean = (xx + yy + zz) * (1.0 / 3.0);
  const Real a = xx - mean;
  const Real b = yy - mean;
  const Real c = zz - mean;
  const Real p2 = (a * a + b * b + c * c + 2.0 * (xy * xy + xz * xz + yz * yz)) * (1.0 / 6.0);
  const Real p = Sqrt(p2);
  const Real half_det =
      0.5 * (a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz));
  // A multiple of the identity has p = 0, where any r will do.
  const Real ratio = half_det / (p2 * p + 1e-300);
  const Real size = Min(Abs(ratio), Real{} + 1.0);
  Real root = 1.7320508 + size * (0.3333333 - size * 0.0653841);
  for (int step = 0; step < 2; ++step) {
    const Real excess = root * root - 1.0;
    const Real value = root * (excess - 2.0) - 2.0 * size;
    const Real slope = 3.0 * excess;
    root -= value * slope / (slope * slope - 3.0 * root * value);
  }
  const Real other = 0.5 * (root + Sqrt(Max(12.0 - 3.0 * root * root, Real{})));
  return mean - p * Select(ratio > 0.0, other, root);
}

}  // namespace sextant
