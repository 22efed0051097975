// SPDX-License-Identifier: Apache-2.0
#include "solvers/max_trace_rotation.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace sextant {
namespace {

// Points within 1e-5 of their length of a line leave the turn about it to rounding.
constexpr double kMinRelativeGap = 1e-10;

// What usual data takes: a fixed count is what the branch predictor learns.
constexpr int kUsualIterations = 2;

// (s1 + s2)(s1 + s3)(s2 + s3) / bound^3 below which the formula loses digits to the eigensolver.
constexpr double kMinSeparation = 1e-3;

// Of the quaternion, by its residual over the gap of the eigenvalues.
constexpr double kMaxError = 1e-12;

// Horn's matrix: q^T K q = trace(R(q) * cross) for q = (x, y, z, w). Named scalars stay in
// registers, where a matrix would wait for its own stores.
struct HornMatrix {
  explicit HornMatrix(const Eigen::Matrix3d& m)
      : xx(m(0, 0) - m(1, 1) - m(2, 2)),
        yy(m(1, 1) - m(0, 0) - m(2, 2)),
        zz(m(2, 2) - m(0, 0) - m(1, 1)),
        ww(m(0, 0) + m(1, 1) + m(2, 2)),
        xy(m(0, 1) + m(1, 0)),
        xz(m(0, 2) + m(2, 0)),
        yz(m(1, 2) + m(2, 1)),
        xw(m(1, 2) - m(2, 1)),
        yw(m(2, 0) - m(0, 2)),
        zw(m(0, 1) - m(1, 0)) {}

  Eigen::Matrix4d Dense() const {
    Eigen::Matrix4d k;
    k << xx, xy, xz, xw, xy, yy, yz, yw, xz, yz, zz, zw, xw, yw, zw, ww;
    return k;
  }

  double xx, yy, zz, ww, xy, xz, yz, xw, yw, zw;
};

// The symmetric functions of the signed singular values that cross gives without an SVD.
struct Invariants {
  double sum_squares;   // s1^2 + s2^2 + s3^2
  double pair_squares;  // (s1 s2)^2 + (s1 s3)^2 + (s2 s3)^2
  double product;       // s1 s2 s3
};

Invariants ComputeInvariants(const Eigen::Matrix3d& m) {
  const double c00 = m(1, 1) * m(2, 2) - m(1, 2) * m(2, 1);
  const double c01 = m(1, 2) * m(2, 0) - m(1, 0) * m(2, 2);
  const double c02 = m(1, 0) * m(2, 1) - m(1, 1) * m(2, 0);
  const double c10 = m(0, 2) * m(2, 1) - m(0, 1) * m(2, 2);
  const double c11 = m(0, 0) * m(2, 2) - m(0, 2) * m(2, 0);
  const double c12 = m(0, 1) * m(2, 0) - m(0, 0) * m(2, 1);
  const double c20 = m(0, 1) * m(1, 2) - m(0, 2) * m(1, 1);
  const double c21 = m(0, 2) * m(1, 0) - m(0, 0) * m(1, 2);
  const double c22 = m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0);
  return {m(0, 0) * m(0, 0) + m(0, 1) * m(0, 1) + m(0, 2) * m(0, 2) +
              (m(1, 0) * m(1, 0) + m(1, 1) * m(1, 1) + m(1, 2) * m(1, 2)) +
              (m(2, 0) * m(2, 0) + m(2, 1) * m(2, 1) + m(2, 2) * m(2, 2)),
          c00 * c00 + c01 * c01 + c02 * c02 + (c10 * c10 + c11 * c11 + c12 * c12) +
              (c20 * c20 + c21 * c21 + c22 * c22),
          m(0, 0) * c00 + m(0, 1) * c01 + m(0, 2) * c02};
}

// The step of Halley's method, which cubes the error and, on a polynomial of real roots, does not
// overshoot from beyond the outermost.
double HalleyStep(double value, double slope, double half_curvature) {
  return value * slope / (slope * slope - value * half_curvature);
}

// s1 + s2 + s3, from above.
std::optional<double> LargestRoot(const Invariants& v, double bound) {
  constexpr int kMaxIterations = 8;
  const double c2 = -2.0 * v.sum_squares;
  const double c1 = -8.0 * v.product;
  const double c0 = v.sum_squares * v.sum_squares - 4.0 * v.pair_squares;
  double x = bound;
  for (int i = 0; i < kMaxIterations; ++i) {
    const double square = x * x;
    const double value = (square + c2) * square + (c1 * x + c0);
    const double slope = 4.0 * x * square + (2.0 * c2 * x + c1);
    const double step = HalleyStep(value, slope, 6.0 * square + c2);
    x -= step;
    if (i + 1 >= kUsualIterations && std::abs(step) <= 1e-6 * bound) return x;
  }
  return std::nullopt;
}

// s3, the least root of x^3 - e1 x^2 + e2 x - e3, from below; none where it is so nearly a multiple
// root that rounding moves it.
std::optional<double> LeastRoot(double e1, double e2, double e3, double start) {
  constexpr int kMaxIterations = 16;
  constexpr double kMinSlope = 1e-5;
  double x = start;
  for (int i = 0; i < kMaxIterations; ++i) {
    const double value = ((x - e1) * x + e2) * x - e3;
    const double slope = (3.0 * x - 2.0 * e1) * x + e2;
    const double step = HalleyStep(value, slope, 3.0 * x - e1);
    x -= step;
    // The root in the middle has a falling slope, the greatest lies above the mean.
    if (!(slope > kMinSlope * e1 * e1 && 3.0 * x < e1)) return std::nullopt;
    // The next step is about step^3 over the square of the distance to s2, which slope / e1 bounds.
    const double cube = std::abs(step * step * step);
    if (i + 1 >= kUsualIterations && cube * e1 <= 1e-8 * slope * slope) return x;
  }
  return std::nullopt;
}

// Halley's step from zero, with the bound in place of e1: it need not wait for e1.
double StartOfLeastRoot(const Invariants& v, double bound) {
  const double e2 = 0.5 * (bound * bound - v.sum_squares);
  return HalleyStep(v.product, e2, bound);
}

struct Vector4 {
  double x, y, z, w;
};

// A null vector of K - shift I, of rank 3: the largest column of its adjugate.
Vector4 NullVector(const HornMatrix& k, double shift) {
  const double xx = k.xx - shift;
  const double yy = k.yy - shift;
  const double zz = k.zz - shift;
  const double ww = k.ww - shift;
  // 2x2 minors of the rows (x, y) and of the rows (z, w), named by their columns.
  const double xy_xy = xx * yy - k.xy * k.xy;
  const double xy_xz = xx * k.yz - k.xz * k.xy;
  const double xy_xw = xx * k.yw - k.xw * k.xy;
  const double xy_yz = k.xy * k.yz - k.xz * yy;
  const double xy_yw = k.xy * k.yw - k.xw * yy;
  const double xy_zw = k.xz * k.yw - k.xw * k.yz;
  const double zw_xz = k.xz * k.zw - zz * k.xw;
  const double zw_xw = k.xz * ww - k.zw * k.xw;
  const double zw_yz = k.yz * k.zw - zz * k.yw;
  const double zw_yw = k.yz * ww - k.zw * k.yw;
  const double zw_zw = zz * ww - k.zw * k.zw;

  const double adj_xx = yy * zw_zw - k.yz * zw_yw + k.yw * zw_yz;
  const double adj_yy = xx * zw_zw - k.xz * zw_xw + k.xw * zw_xz;
  const double adj_zz = k.xw * xy_yw - k.yw * xy_xw + ww * xy_xy;
  const double adj_ww = k.xz * xy_yz - k.yz * xy_xz + zz * xy_xy;
  const double adj_xy = k.xz * zw_yw - k.xy * zw_zw - k.xw * zw_yz;
  const double adj_xz = k.yw * xy_zw - k.zw * xy_yw + ww * xy_yz;
  const double adj_xw = zz * xy_yw - k.zw * xy_yz - k.yz * xy_zw;
  const double adj_yz = k.zw * xy_xw - k.xw * xy_zw - ww * xy_xz;
  const double adj_yw = k.xz * xy_zw + k.zw * xy_xz - zz * xy_xw;
  const double adj_zw = k.yz * xy_xw - k.xz * xy_yw - k.zw * xy_xy;

  // The adjugate is a negative multiple of q q^T: the most negative of the diagonal is the largest.
  Vector4 x = {adj_xx, adj_xy, adj_xz, adj_xw};
  Vector4 y = {adj_xy, adj_yy, adj_yz, adj_yw};
  Vector4 z = {adj_xz, adj_yz, adj_zz, adj_zw};
  Vector4 w = {adj_xw, adj_yw, adj_zw, adj_ww};
  const Vector4& xy = adj_xx < adj_yy ? x : y;
  const Vector4& zw = adj_zz < adj_ww ? z : w;
  return std::min(adj_xx, adj_yy) < std::min(adj_zz, adj_ww) ? xy : zw;
}

struct Eigenpair {
  double value;
  Vector4 vector;  // Unit length.
};

// The eigenvector of a nearly exact eigenvalue, which the Rayleigh quotient makes exact; none where
// two rounds leave a residual above `tolerance`.
std::optional<Eigenpair> Polish(const HornMatrix& k, double value, double tolerance) {
  for (int round = 0; round < 2; ++round) {
    const Vector4 q = NullVector(k, value);
    const double rx = (k.xx - value) * q.x + k.xy * q.y + (k.xz * q.z + k.xw * q.w);
    const double ry = k.xy * q.x + (k.yy - value) * q.y + (k.yz * q.z + k.yw * q.w);
    const double rz = k.xz * q.x + k.yz * q.y + ((k.zz - value) * q.z + k.zw * q.w);
    const double rw = k.xw * q.x + k.yw * q.y + (k.zw * q.z + (k.ww - value) * q.w);
    const double length2 = q.x * q.x + q.y * q.y + (q.z * q.z + q.w * q.w);
    const double residual2 = rx * rx + ry * ry + (rz * rz + rw * rw);
    const double shift = (q.x * rx + q.y * ry + (q.z * rz + q.w * rw)) / length2;
    value += shift;
    if (residual2 <= tolerance * tolerance * length2) {
      const double scale = 1.0 / std::sqrt(length2);
      return Eigenpair{value, {scale * q.x, scale * q.y, scale * q.z, scale * q.w}};
    }
  }
  return std::nullopt;
}

// The closed form; none where it cannot prove itself.
std::optional<MaxTraceRotation> ByFormula(const Eigen::Matrix3d& cross, const HornMatrix& horn,
                                          double bound) {
  const Invariants v = ComputeInvariants(cross);
  const std::optional<double> e1 = LargestRoot(v, bound);
  if (!e1) return std::nullopt;
  const double e2 = 0.5 * (*e1 * *e1 - v.sum_squares);
  const double separation = *e1 * e2 - v.product;  // (s1 + s2)(s1 + s3)(s2 + s3)
  if (!(separation > kMinSeparation * bound * bound * bound)) return std::nullopt;
  const std::optional<double> s3 = LeastRoot(*e1, e2, v.product, StartOfLeastRoot(v, bound));
  if (!s3) return std::nullopt;
  // The two largest eigenvalues are s2 + s3 > separation / (4 bound^2) apart.
  const double tolerance = kMaxError * separation / (4.0 * bound * bound);
  const std::optional<Eigenpair> best = Polish(horn, *e1, tolerance);
  if (!best) return std::nullopt;
  const Vector4& q = best->vector;
  return MaxTraceRotation{Eigen::Quaterniond(q.w, q.x, q.y, q.z), best->value,
                          best->value - 2.0 * *s3};
}

std::optional<MaxTraceRotation> ByEigensolver(const HornMatrix& horn, double bound) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(horn.Dense());
  const Eigen::Vector4d& lambda = eigen.eigenvalues();
  if (!(lambda(3) - lambda(2) > kMinRelativeGap * bound)) return std::nullopt;
  return MaxTraceRotation{Eigen::Quaterniond(eigen.eigenvectors().col(3)).normalized(), lambda(3),
                          -lambda(0)};
}

}  // namespace

std::optional<MaxTraceRotation> MaximizeTrace(const Eigen::Matrix3d& cross, double trace_bound) {
  const HornMatrix horn(cross);
  std::optional<MaxTraceRotation> best = ByFormula(cross, horn, trace_bound);
  if (!best) best = ByEigensolver(horn, trace_bound);
  return best;
}

}  // namespace sextant
