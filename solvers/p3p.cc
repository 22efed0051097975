// SPDX-License-Identifier: Apache-2.0
#include "solvers/p3p.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace sextant {
namespace {

// Squared height of the triangle over its longest side: flatter, and the turn about that side is
// left to rounding.
constexpr double kMinSquaredHeight = 1e-12;

// A symmetric 3x3 matrix: the conic xx u^2 + 2 xy u v + yy v^2 + 2 xz u + 2 yz v + zz = 0.
struct Conic {
  double xx, xy, xz, yy, yz, zz;
};

Conic Combine(const Conic& a, double factor, const Conic& b) {
  return {a.xx + factor * b.xx, a.xy + factor * b.xy, a.xz + factor * b.xz,
          a.yy + factor * b.yy, a.yz + factor * b.yz, a.zz + factor * b.zz};
}

Conic Adjugate(const Conic& c) {
  return {c.yy * c.zz - c.yz * c.yz, c.xz * c.yz - c.xy * c.zz, c.xy * c.yz - c.xz * c.yy,
          c.xx * c.zz - c.xz * c.xz, c.xy * c.xz - c.xx * c.yz, c.xx * c.yy - c.xy * c.xy};
}

// trace(a b)
double Trace(const Conic& a, const Conic& b) {
  return a.xx * b.xx + a.yy * b.yy + a.zz * b.zz + 2.0 * (a.xy * b.xy + a.xz * b.xz + a.yz * b.yz);
}

// The root of x^3 + b x^2 + c x + d that is farthest from the other two, or the only real one.
double IsolatedRoot(double b, double c, double d) {
  const double shift = b / 3.0;
  const double p = c - b * shift;
  const double q = d + shift * (2.0 * shift * shift - c);
  // t^3 + p t + q at x = t - shift; the isolated root has the sign opposite to q.
  const double third = p / 3.0;
  const double discriminant = 0.25 * q * q + third * third * third;
  double t;
  if (discriminant > 0.0) {
    const double u = std::cbrt(0.5 * std::abs(q) + std::sqrt(discriminant));
    t = u - third / u;
  } else {
    t = 2.0 * std::sqrt(-third);
  }
  if (q > 0.0) t = -t;
  // From an upper bound of its size Newton's method descends on the root without overshooting.
  for (int step = 0; step < 8; ++step) {
    const double slope = 3.0 * t * t + p;
    if (!(slope > 0.0)) break;
    const double change = ((t * t + p) * t + q) / slope;
    t -= change;
    if (std::abs(change) <= 1e-10 * std::abs(t)) break;
  }
  return t - shift;
}

// det(a + x b) = c0 + c1 x + c2 x^2 + c3 x^3.
struct Cubic {
  double c0, c1, c2, c3;
};

Cubic DeterminantOfPencil(const Conic& a, const Conic& b) {
  const Conic adjugate_a = Adjugate(a);
  const Conic adjugate_b = Adjugate(b);
  return {Trace(adjugate_a, a) / 3.0, Trace(adjugate_a, b), Trace(adjugate_b, a),
          Trace(adjugate_b, b) / 3.0};
}

struct Pencil {
  Conic degenerate;
  Conic other;  // A member that is far from the degenerate one.
};

// a + x b, and the one of a and b that is less of it.
Pencil MemberAt(double x, const Conic& a, const Conic& b) {
  return {Combine(a, x, b), std::abs(x) <= 1.0 ? b : a};
}

// Splits the pencil at the degenerate conic that is farthest from the other two.
Pencil FindDegenerate(Conic a, Conic b) {
  Cubic c = DeterminantOfPencil(a, b);
  // Where both are nearly degenerate (symmetric scenes), no root is well scaled from either.
  constexpr double kTooSmall = 1e-3;
  if (std::max(std::abs(c.c0), std::abs(c.c3)) <
      kTooSmall * std::max(std::abs(c.c1), std::abs(c.c2))) {
    const Conic sum = Combine(a, 1.0, b);
    b = Combine(a, -1.0, b);
    a = sum;
    c = DeterminantOfPencil(a, b);
  }
  if (std::abs(c.c3) >= std::abs(c.c0)) {
    return MemberAt(IsolatedRoot(c.c2 / c.c3, c.c1 / c.c3, c.c0 / c.c3), a, b);
  }
  return MemberAt(IsolatedRoot(c.c1 / c.c0, c.c2 / c.c0, c.c3 / c.c0), b, a);
}

using Line = Eigen::Vector3d;  // l.x u + l.y v + l.z = 0

// A degenerate conic is p q^T + q p^T, and its adjugate -(p x q)(p x q)^T; [p x q]x added leaves
// 2 q p^T, of which every row is p and every column q. The largest ones are the most precise.
std::array<Line, 2> SplitIntoLines(const Conic& c) {
  const Conic adjugate = Adjugate(c);
  Eigen::Vector3d w(adjugate.xx, adjugate.xy, adjugate.xz);
  double square = -adjugate.xx;
  if (-adjugate.yy > square) {
    w << adjugate.xy, adjugate.yy, adjugate.yz;
    square = -adjugate.yy;
  }
  if (-adjugate.zz > square) {
    w << adjugate.xz, adjugate.yz, adjugate.zz;
    square = -adjugate.zz;
  }
  // Where the lines are complex (square < 0) their real part passes for a double line; what it
  // meets is thrown out by the polish.
  w *= square > 0.0 ? -1.0 / std::sqrt(square) : 0.0;
  Eigen::Matrix3d m;
  m << c.xx, c.xy - w.z(), c.xz + w.y(), c.xy + w.z(), c.yy, c.yz - w.x(), c.xz - w.y(),
      c.yz + w.x(), c.zz;
  int row = 0;
  int column = 0;
  m.cwiseAbs().maxCoeff(&row, &column);
  return {Line(m.row(row)), Line(m.col(column))};
}

// The two points where a line meets a conic; a narrow miss counts as touching.
bool Intersect(const Line& line, const Conic& c, std::array<Eigen::Vector2d, 2>& points) {
  constexpr double kNarrowMiss = 1e-6;
  // From the point of the line nearest to the origin, so that no slope is infinite.
  const Eigen::Vector2d direction(-line.y(), line.x());
  const Eigen::Vector2d foot = -line.z() / line.head<2>().squaredNorm() * line.head<2>();
  const Eigen::Vector2d turned(c.xx * direction.x() + c.xy * direction.y(),
                               c.xy * direction.x() + c.yy * direction.y());
  const double square = turned.dot(direction);
  const double half = turned.dot(foot) + c.xz * direction.x() + c.yz * direction.y();
  const double constant = (c.xx * foot.x() + 2.0 * (c.xy * foot.y() + c.xz)) * foot.x() +
                          (c.yy * foot.y() + 2.0 * c.yz) * foot.y() + c.zz;
  const double discriminant = half * half - square * constant;
  if (!(discriminant >= -kNarrowMiss * half * half)) return false;
  const double sum = -(half + std::copysign(std::sqrt(std::max(0.0, discriminant)), half));
  points[0] = foot + sum / square * direction;
  points[1] = sum == 0.0 ? points[0] : Eigen::Vector2d(foot + constant / sum * direction);
  return true;
}

struct Triangle {
  double a12, a13;       // squared sides, in units of the third
  double e12, e13, e23;  // squared chords of the rays
};

// Residuals of the law of cosines.
Eigen::Vector3d SideErrors(const Triangle& t, const Eigen::Vector3d& d) {
  const double d12 = d[0] - d[1];
  const double d13 = d[0] - d[2];
  const double d23 = d[1] - d[2];
  return {d12 * d12 + t.e12 * d[0] * d[1] - t.a12, d13 * d13 + t.e13 * d[0] * d[2] - t.a13,
          d23 * d23 + t.e23 * d[1] * d[2] - 1.0};
}

Eigen::Vector3d NewtonStep(const Triangle& t, const Eigen::Vector3d& d, const Eigen::Vector3d& r) {
  const double d12 = 2.0 * (d[0] - d[1]);
  const double d13 = 2.0 * (d[0] - d[2]);
  const double d23 = 2.0 * (d[1] - d[2]);
  const double j11 = d12 + t.e12 * d[1];
  const double j12 = t.e12 * d[0] - d12;
  const double j21 = d13 + t.e13 * d[2];
  const double j23 = t.e13 * d[0] - d13;
  const double j32 = d23 + t.e23 * d[2];
  const double j33 = t.e23 * d[1] - d23;
  const double inverse = 1.0 / (j11 * j23 * j32 + j12 * j21 * j33);
  return inverse * Eigen::Vector3d(j23 * j32 * r[0] + j12 * (j33 * r[1] - j23 * r[2]),
                                   j33 * (j21 * r[0] - j11 * r[1]) + j11 * j23 * r[2],
                                   j32 * (j11 * r[1] - j21 * r[0]) + j12 * j21 * r[2]);
}

// Newton's method on the law of cosines as long as it gains; false where the sides stay wrong.
bool Polish(const Triangle& t, Eigen::Vector3d& d) {
  constexpr int kMaxSteps = 6;
  constexpr double kMaxError = 1e-9;
  Eigen::Vector3d residual = SideErrors(t, d);
  double error = residual.lpNorm<1>();
  // What the rounding of depths so large leaves of a side of length one.
  const double rounding = 1e-15 * d.sum();
  for (int step = 0; step < kMaxSteps && error > rounding; ++step) {
    const Eigen::Vector3d next = d - NewtonStep(t, d, residual);
    residual = SideErrors(t, next);
    const double next_error = residual.lpNorm<1>();
    if (!(next_error < error)) break;
    d = next;
    error = next_error;
  }
  return error < kMaxError && d.minCoeff() > 0.0;
}

// The ratios (d_1, d_2) / d_3 less one, over the widest chord: where the two conics meet.
struct RatioConics {
  Conic c12, c13;
  double widest;  // chord
};

RatioConics MakeConics(const Triangle& t) {
  const double square = std::max({t.e12, t.e13, t.e23});
  const double s = std::sqrt(square);
  const double inverse = 1.0 / square;
  const double f12 = t.e12 * inverse;
  const double f13 = t.e13 * inverse;
  const double f23 = t.e23 * inverse;
  const double g12 = f12 - t.a12 * f23;
  const double g13 = f13 - t.a13 * f23;
  return {{1.0, 0.5 * t.e12 - 1.0, 0.5 * s * f12, 1.0 - t.a12, 0.5 * s * g12, g12},
          {1.0, 0.0, 0.5 * s * f13, -t.a13, -0.5 * s * t.a13 * f23, g13},
          s};
}

// All depths, in units of the third side; returns how many.
int SolveDepths(const Triangle& t, std::array<Eigen::Vector3d, kMaxP3pPoses>& depths) {
  const RatioConics conics = MakeConics(t);
  const Pencil pencil = FindDegenerate(conics.c12, conics.c13);
  std::size_t count = 0;
  for (const Line& line : SplitIntoLines(pencil.degenerate)) {
    std::array<Eigen::Vector2d, 2> ratios;
    if (!Intersect(line, pencil.other, ratios)) continue;
    for (const Eigen::Vector2d& ratio : ratios) {
      const double x = 1.0 + conics.widest * ratio.x();
      const double y = 1.0 + conics.widest * ratio.y();
      if (!(x > 0.0 && y > 0.0)) continue;
      const double third = 1.0 / std::sqrt((y - 1.0) * (y - 1.0) + t.e23 * y);
      depths[count] = {x * third, y * third, third};
      if (Polish(t, depths[count])) ++count;
    }
  }
  return static_cast<int>(count);
}

}  // namespace

int SolveP3p(std::span<const Eigen::Vector3d, 3> rays_in_cam,
             std::span<const Eigen::Vector3d, 3> points_in_lidar,
             std::span<Rigid3d, kMaxP3pPoses> poses) {
  const auto squared_side = [&](std::size_t i, std::size_t j) {
    return (points_in_lidar[i] - points_in_lidar[j]).squaredNorm();
  };
  // Numbered so that the side from 2 to 3 is the longest: the others are divided by it.
  const double opposite[3] = {squared_side(1, 2), squared_side(2, 0), squared_side(0, 1)};
  std::size_t first = opposite[0] >= opposite[1] ? 0 : 1;
  if (opposite[2] > opposite[first]) first = 2;
  const std::size_t second = (first + 1) % 3;
  const std::size_t third = (first + 2) % 3;
  const Eigen::Vector3d& y1 = rays_in_cam[first];
  const Eigen::Vector3d& y2 = rays_in_cam[second];
  const Eigen::Vector3d& y3 = rays_in_cam[third];
  const Eigen::Vector3d& p3 = points_in_lidar[third];
  const double side = std::sqrt(opposite[first]);

  Eigen::Matrix3d frame;
  frame.col(0) = (points_in_lidar[first] - p3) / side;
  frame.col(1) = (points_in_lidar[second] - p3) / side;
  frame.col(2) = frame.col(0).cross(frame.col(1));
  if (!(frame.col(2).squaredNorm() > kMinSquaredHeight)) return 0;
  const Eigen::Matrix3d frame_inverse = frame.inverse();

  const Triangle triangle = {opposite[third] / opposite[first], opposite[second] / opposite[first],
                             (y1 - y2).squaredNorm(), (y1 - y3).squaredNorm(),
                             (y2 - y3).squaredNorm()};
  std::array<Eigen::Vector3d, kMaxP3pPoses> depths;
  const int count = SolveDepths(triangle, depths);
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d& d = depths[static_cast<std::size_t>(i)];
    const Eigen::Vector3d q3 = d[2] * y3;
    Eigen::Matrix3d seen;
    seen.col(0) = d[0] * y1 - q3;
    seen.col(1) = d[1] * y2 - q3;
    seen.col(2) = seen.col(0).cross(seen.col(1));
    Rigid3d& pose = poses[static_cast<std::size_t>(i)];
    pose.rotation = Eigen::Quaterniond(Eigen::Matrix3d(seen * frame_inverse)).normalized();
    pose.translation = side * q3 - pose.rotation * p3;
  }
  return count;
}

}  // namespace sextant
