// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "solvers/kernels/eight_problems.h"

namespace sextant::p3p {

/// The equations of SolveP3p for one triple (T = double) and for eight triples (T = Vec8d), without
/// branches that depend on the numbers, so that both do the same arithmetic. From the four
/// candidates on, U is the type of the unknowns: Vec4d for the four candidates of one triple, Vec8d
/// for one candidate of eight triples.

/// A symmetric 3x3 matrix: the conic xx u^2 + 2 xy u v + yy v^2 + 2 xz u + 2 yz v + zz = 0.
template <class T>
struct Conic {
  T xx, xy, xz, yy, yz, zz;
};

/// a + factor b
template <class T>
SEXTANT_INLINE Conic<T> Combine(const Conic<T>& a, const T& factor, const Conic<T>& b) {
  return {a.xx + factor * b.xx, a.xy + factor * b.xy, a.xz + factor * b.xz,
          a.yy + factor * b.yy, a.yz + factor * b.yz, a.zz + factor * b.zz};
}

template <class T, class Mask>
SEXTANT_INLINE Conic<T> Select(const Mask& mask, const Conic<T>& a, const Conic<T>& b) {
  return {Select(mask, a.xx, b.xx), Select(mask, a.xy, b.xy), Select(mask, a.xz, b.xz),
          Select(mask, a.yy, b.yy), Select(mask, a.yz, b.yz), Select(mask, a.zz, b.zz)};
}

template <class T>
SEXTANT_INLINE Conic<T> Adjugate(const Conic<T>& c) {
  return {c.yy * c.zz - c.yz * c.yz, c.xz * c.yz - c.xy * c.zz, c.xy * c.yz - c.xz * c.yy,
          c.xx * c.zz - c.xz * c.xz, c.xy * c.xz - c.xx * c.yz, c.xx * c.yy - c.xy * c.xy};
}

/// trace(a b)
template <class T>
SEXTANT_INLINE T Trace(const Conic<T>& a, const Conic<T>& b) {
  return a.xx * b.xx + a.yy * b.yy + a.zz * b.zz + 2.0 * (a.xy * b.xy + a.xz * b.xz + a.yz * b.yz);
}

/// The root of x^3 + b x^2 + c x + d that is farthest from the other two, or the only real one.
template <class T>
SEXTANT_INLINE T IsolatedRoot(const T& b, const T& c, const T& d) {
  constexpr double kThird = 1.0 / 3.0;
  const T shift = b * kThird;
  const T p = c - b * shift;
  const T q = d + shift * (2.0 * shift * shift - c);
  // s^3 + p s + q at x = s - shift; the isolated root has the sign opposite to q.
  const T third = p * kThird;
  const T discriminant = 0.25 * q * q + third * third * third;
  const T u = RoughCubeRoot<T>(0.5 * Size(q) + SquareRoot(AtLeastZero(discriminant)));
  T s = Select(discriminant > 0.0, u - third / u, 2.0 * SquareRoot(AtLeastZero<T>(-third)));
  s = Select(q > 0.0, -s, s);
  // From an upper bound of its size Newton's method descends to the root without overshooting. The
  // error after a step under the tolerance is about the square of that step.
  for (int step = 0; step < 8; ++step) {
    const T slope = 3.0 * s * s + p;
    const T change = Select(slope > 0.0, ((s * s + p) * s + q) / slope, T{});
    s = s - change;
    if (!Any(Size(change) > 1e-7 * Size(s))) break;
  }
  return s - shift;
}

/// det(a + x b) = c0 + c1 x + c2 x^2 + c3 x^3.
template <class T>
struct Cubic {
  T c0, c1, c2, c3;
};

template <class T>
SEXTANT_INLINE Cubic<T> DeterminantOfPencil(const Conic<T>& a, const Conic<T>& b) {
  const Conic<T> adjugate_a = Adjugate(a);
  const Conic<T> adjugate_b = Adjugate(b);
  constexpr double kThird = 1.0 / 3.0;
  return {Trace(adjugate_a, a) * kThird, Trace(adjugate_a, b), Trace(adjugate_b, a),
          Trace(adjugate_b, b) * kThird};
}

template <class T>
struct Pencil {
  Conic<T> degenerate;
  Conic<T> other;  ///< A member that is far from the degenerate one.
};

/// Splits the pencil at the degenerate conic that is farthest from the other two.
template <class T>
SEXTANT_INLINE Pencil<T> FindDegenerate(Conic<T> a, Conic<T> b) {
  Cubic<T> c = DeterminantOfPencil(a, b);
  // If both conics are nearly degenerate (symmetric scenes), no root is well scaled from either.
  constexpr double kTooSmall = 1e-3;
  const auto both = Larger(Size(c.c0), Size(c.c3)) < kTooSmall * Larger(Size(c.c1), Size(c.c2));
  if (Any(both)) {
    const Conic<T> sum = Combine<T>(a, T{} + 1.0, b);
    b = Select(both, Combine<T>(a, T{} - 1.0, b), b);
    a = Select(both, sum, a);
    c = DeterminantOfPencil(a, b);
  }
  // Divide by the larger of the first and last coefficients.
  const auto ascending = Size(c.c3) >= Size(c.c0);
  const T inverse = 1.0 / Select(ascending, c.c3, c.c0);
  const T x = IsolatedRoot<T>(Select(ascending, c.c2, c.c1) * inverse,
                              Select(ascending, c.c1, c.c2) * inverse,
                              Select(ascending, c.c0, c.c3) * inverse);
  const Conic<T> first = Select(ascending, a, b);
  const Conic<T> second = Select(ascending, b, a);
  return {Combine(first, x, second), Select(Size(x) <= 1.0, second, first)};
}

/// The lines l.x u + l.y v + l.z = 0 that a degenerate conic consists of. The conic is
/// p q^T + q p^T, and its adjugate -(p x q)(p x q)^T; adding [p x q]x gives 2 q p^T, in which every
/// row is a multiple of p and every column of q. The longest ones are the most precise.
template <class T>
SEXTANT_INLINE void SplitIntoLines(const Conic<T>& c, Vector<T>& p, Vector<T>& q) {
  const Conic<T> adjugate = Adjugate(c);
  Vector<T> w = {adjugate.xx, adjugate.xy, adjugate.xz};
  T square = -adjugate.xx;
  const auto y_larger = -adjugate.yy > square;
  w = Select(y_larger, {adjugate.xy, adjugate.yy, adjugate.yz}, w);
  square = Select(y_larger, -adjugate.yy, square);
  const auto z_larger = -adjugate.zz > square;
  w = Select(z_larger, {adjugate.xz, adjugate.yz, adjugate.zz}, w);
  square = Select(z_larger, -adjugate.zz, square);
  // Where the lines are complex (square < 0), their real part is used as a double line; Polish
  // rejects its intersections.
  const auto is_real = square > 0.0;
  const T scale = Select(is_real, -1.0 / SquareRoot(Select(is_real, square, T{} + 1.0)), T{});
  w = scale * w;
  const Vector<T> rows[3] = {{c.xx, c.xy - w.z, c.xz + w.y},
                             {c.xy + w.z, c.yy, c.yz - w.x},
                             {c.xz - w.y, c.yz + w.x, c.zz}};
  const Vector<T> columns[3] = {{rows[0].x, rows[1].x, rows[2].x},
                                {rows[0].y, rows[1].y, rows[2].y},
                                {rows[0].z, rows[1].z, rows[2].z}};
  const auto longest = [](const Vector<T>(&lines)[3]) __attribute__((always_inline)) {
    const auto length = [](const Vector<T>& l) __attribute__((always_inline)) { return Dot(l, l); };
    const T first = length(lines[0]);
    const T second = length(lines[1]);
    const auto is_second = second > first;
    return Select(length(lines[2]) > Larger(first, second), lines[2],
                  Select(is_second, lines[1], lines[0]));
  };
  p = longest(rows);
  q = longest(columns);
}

/// The two points where a line meets a conic; NaN where it misses. A narrow miss counts as
/// touching.
template <class T>
SEXTANT_INLINE void Intersect(const Vector<T>& line, const Conic<T>& c, T (&u)[2], T (&v)[2]) {
  constexpr double kNarrowMiss = 1e-6;
  // Parametrised from the point of the line nearest to the origin, so that no slope is infinite.
  const T du = -line.y;
  const T dv = line.x;
  const T back = -line.z / (line.x * line.x + line.y * line.y);
  const T foot_u = back * line.x;
  const T foot_v = back * line.y;
  const T turned_u = c.xx * du + c.xy * dv;
  const T turned_v = c.xy * du + c.yy * dv;
  const T square = turned_u * du + turned_v * dv;
  const T half = turned_u * foot_u + turned_v * foot_v + c.xz * du + c.yz * dv;
  const T constant = (c.xx * foot_u + 2.0 * (c.xy * foot_v + c.xz)) * foot_u +
                     (c.yy * foot_v + 2.0 * c.yz) * foot_v + c.zz;
  const T discriminant = half * half - square * constant;
  const T gap = discriminant + kNarrowMiss * half * half;
  const T root = SquareRoot(AtLeastZero(discriminant));
  const T sum = Select(gap >= 0.0, -(half + Select(half < 0.0, -root, root)),
                       T{} + std::numeric_limits<double>::quiet_NaN());
  const T first = sum / square;
  const T second = Select(sum == 0.0, first, constant / sum);
  u[0] = foot_u + first * du;
  v[0] = foot_v + first * dv;
  u[1] = foot_u + second * du;
  v[1] = foot_v + second * dv;
}

template <class T>
struct Triangle {
  T a12, a13;       ///< Squared sides, in units of the third.
  T e12, e13, e23;  ///< Squared chords of the rays.
};

/// Candidates for the ratios (d_1, d_2) / d_3: the intersections of the two conics. The conics are
/// in the ratios minus one, divided by the longest chord.
template <class T>
SEXTANT_INLINE void FindRatios(const Triangle<T>& t, T (&x)[4], T (&y)[4]) {
  const T square = Larger(Larger(t.e12, t.e13), t.e23);
  const T s = SquareRoot(square);
  const T inverse = 1.0 / square;
  const T f12 = t.e12 * inverse;
  const T f13 = t.e13 * inverse;
  const T f23 = t.e23 * inverse;
  const T g12 = f12 - t.a12 * f23;
  const T g13 = f13 - t.a13 * f23;
  const T one = T{} + 1.0;
  const Conic<T> c12 = {one, 0.5 * t.e12 - 1.0, 0.5 * s * f12, 1.0 - t.a12, 0.5 * s * g12, g12};
  const Conic<T> c13 = {one, T{}, 0.5 * s * f13, -t.a13, -0.5 * s * t.a13 * f23, g13};
  const Pencil<T> pencil = FindDegenerate(c12, c13);
  Vector<T> lines[2];
  SplitIntoLines(pencil.degenerate, lines[0], lines[1]);
  for (int line = 0; line < 2; ++line) {
    T u[2];
    T v[2];
    Intersect(lines[line], pencil.other, u, v);
    for (int k = 0; k < 2; ++k) {
      x[2 * line + k] = 1.0 + s * u[k];
      y[2 * line + k] = 1.0 + s * v[k];
    }
  }
}

/// Residuals of the law of cosines.
template <class U, class T>
SEXTANT_INLINE Vector<U> SideErrors(const Triangle<T>& t, const Vector<U>& d) {
  const U d12 = d.x - d.y;
  const U d13 = d.x - d.z;
  const U d23 = d.y - d.z;
  return {d12 * d12 + t.e12 * d.x * d.y - t.a12, d13 * d13 + t.e13 * d.x * d.z - t.a13,
          d23 * d23 + t.e23 * d.y * d.z - 1.0};
}

template <class U, class T>
SEXTANT_INLINE Vector<U> NewtonStep(const Triangle<T>& t, const Vector<U>& d, const Vector<U>& r) {
  const U d12 = 2.0 * (d.x - d.y);
  const U d13 = 2.0 * (d.x - d.z);
  const U d23 = 2.0 * (d.y - d.z);
  const U j11 = d12 + t.e12 * d.y;
  const U j12 = t.e12 * d.x - d12;
  const U j21 = d13 + t.e13 * d.z;
  const U j23 = t.e13 * d.x - d13;
  const U j32 = d23 + t.e23 * d.z;
  const U j33 = t.e23 * d.y - d23;
  const U inverse = 1.0 / (j11 * j23 * j32 + j12 * j21 * j33);
  return inverse * Vector<U>{j23 * j32 * r.x + j12 * (j33 * r.y - j23 * r.z),
                             j33 * (j21 * r.x - j11 * r.y) + j11 * j23 * r.z,
                             j32 * (j11 * r.y - j21 * r.x) + j12 * j21 * r.z};
}

template <class U>
SEXTANT_INLINE U SumOfSizes(const Vector<U>& a) {
  return Size(a.x) + Size(a.y) + Size(a.z);
}

/// Depths from their ratios, in units of the third side, by Newton's method on the law of cosines
/// as long as the error falls. The returned number is positive where they are a solution.
template <class U, class T>
SEXTANT_INLINE U Polish(const Triangle<T>& t, const U& x, const U& y, Vector<U>& d) {
  constexpr int kMaxSteps = 6;
  constexpr double kMaxError = 1e-9;
  const U third = 1.0 / SquareRoot((y - 1.0) * (y - 1.0) + t.e23 * y);
  d = {x * third, y * third, third};
  // NaN is no solution from here on: it never compares as smaller.
  Vector<U> residual = SideErrors(t, d);
  U error = SumOfSizes(residual);
  // The effect of rounding depths of this size on a side of length one.
  const U rounding = 1e-15 * (d.x + d.y + d.z);
  for (int step = 0; step < kMaxSteps; ++step) {
    const Vector<U> next = d - NewtonStep(t, d, residual);
    const Vector<U> next_residual = SideErrors(t, next);
    const U next_error = SumOfSizes(next_residual);
    const auto better = next_error < error;
    d = Select(better, next, d);
    residual = Select(better, next_residual, residual);
    error = Select(better, next_error, error);
    if (!Any(Select(better, error, U{}) > rounding)) break;
  }
  const U nearer = Select(d.x < d.y, d.x, d.y);
  const U ratio = Select(x < y, x, y);
  const U depth = Select(d.z < nearer, d.z, nearer);
  return Select(error < kMaxError, Select(ratio > 0.0, depth, ratio), U{} - 1.0);
}

/// A triple whose points are numbered so that the side from 2 to 3 is the longest, which is the
/// unit of length.
template <class T>
struct Prepared {
  Vector<T> ray[3];
  Vector<T> origin;         ///< Point 3.
  T side;                   ///< From 2 to 3.
  Vector<T> frame_rows[3];  ///< The inverse of [p1 - p3, p2 - p3, their cross product].
  Triangle<T> triangle;
  T squared_height;  ///< Height of the triangle; see kMinSquaredHeight.
};

template <class T>
SEXTANT_INLINE Prepared<T> Prepare(const Vector<T> (&rays)[3], const Vector<T> (&points)[3]) {
  const auto squared = [](const Vector<T>& a) __attribute__((always_inline)) { return Dot(a, a); };
  const T opposite[3] = {squared(points[1] - points[2]), squared(points[2] - points[0]),
                         squared(points[0] - points[1])};
  const auto second_longer = opposite[1] > opposite[0];
  const T longer = Select(second_longer, opposite[1], opposite[0]);
  const auto third_longest = opposite[2] > longer;
  // The element that becomes the first, second or third.
  const auto pick = [&](const auto(&of)[3], int shift) __attribute__((always_inline)) {
    return Select(third_longest, of[(2 + shift) % 3],
                  Select(second_longer, of[(1 + shift) % 3], of[shift]));
  };
  Prepared<T> out;
  for (int k = 0; k < 3; ++k) out.ray[k] = pick(rays, k);
  out.origin = pick(points, 2);
  const T square = pick(opposite, 0);
  const T inverse_square = 1.0 / square;
  out.side = SquareRoot(square);
  const T inverse_side = out.side * inverse_square;
  const Vector<T> first = inverse_side * (pick(points, 0) - out.origin);
  const Vector<T> second = inverse_side * (pick(points, 1) - out.origin);
  const Vector<T> normal = Cross(first, second);
  out.squared_height = Dot(normal, normal);
  const T inverse_height = 1.0 / out.squared_height;
  out.frame_rows[0] = inverse_height * Cross(second, normal);
  out.frame_rows[1] = inverse_height * Cross(normal, first);
  out.frame_rows[2] = inverse_height * normal;
  out.triangle = {pick(opposite, 2) * inverse_square, pick(opposite, 1) * inverse_square,
                  squared(out.ray[0] - out.ray[1]), squared(out.ray[0] - out.ray[2]),
                  squared(out.ray[1] - out.ray[2])};
  return out;
}

/// R row by row and t of the pose that puts the points at depths d. R is as orthonormal as the side
/// lengths are exact.
template <class U, class T>
SEXTANT_INLINE void PoseAt(const Prepared<T>& from, const Vector<U>& d, U (&r)[9], U (&t)[3]) {
  const auto along = [](const U& depth, const Vector<T>& ray) __attribute__((always_inline)) {
    return Vector<U>{depth * ray.x, depth * ray.y, depth * ray.z};
  };
  const Vector<U> third = along(d.z, from.ray[2]);
  const Vector<U> first = along(d.x, from.ray[0]) - third;
  const Vector<U> second = along(d.y, from.ray[1]) - third;
  const Vector<U> normal = Cross(first, second);
  const U rows[3][3] = {
      {first.x, second.x, normal.x}, {first.y, second.y, normal.y}, {first.z, second.z, normal.z}};
  const U q[3] = {third.x, third.y, third.z};
  const Vector<T>* f = from.frame_rows;
  for (int i = 0; i < 3; ++i) {
    r[3 * i] = rows[i][0] * f[0].x + rows[i][1] * f[1].x + rows[i][2] * f[2].x;
    r[3 * i + 1] = rows[i][0] * f[0].y + rows[i][1] * f[1].y + rows[i][2] * f[2].y;
    r[3 * i + 2] = rows[i][0] * f[0].z + rows[i][1] * f[1].z + rows[i][2] * f[2].z;
    t[i] = from.side * q[i] -
           (r[3 * i] * from.origin.x + r[3 * i + 1] * from.origin.y + r[3 * i + 2] * from.origin.z);
  }
}

/// Minimum squared height of the triangle relative to its longest side: in a flatter one, rounding
/// decides the rotation about that side.
inline constexpr double kMinSquaredHeight = 1e-12;

}  // namespace sextant::p3p
