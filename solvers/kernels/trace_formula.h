// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>

#include "solvers/kernels/horn_matrix.h"
#include "solvers/kernels/max_trace_rotation.h"

namespace sextant {

/// MaximizeTrace without its eigensolver, inlined into kernels. See max_trace_rotation.h.

// SeparationOf / bound^3 below which the formula loses digits to the eigensolver.
inline constexpr double kMinSeparation = 1e-6;

// Maximum error of the quaternion: its residual over the gap of the eigenvalues.
inline constexpr double kMaxEigenvectorError = 1e-12;

// Rounding of K q, relative to the bound; an eigensolver has it too.
inline constexpr double kResidualRounding = 4e-15;

/// (s1 + s2)(s1 + s3)(s2 + s3); over 4 bound^2 it is less than the gap s2 + s3 of the two largest
/// eigenvalues.
template <class Real>
SEXTANT_INLINE Real SeparationOf(const Invariants<Real>& v, const Real& e1) {
  return e1 * (0.5 * (e1 * e1 - v.sum_squares)) - v.product;
}

/// Whether the components along the other eigenvectors are at most rounding, or 1e-12: the residual
/// is under the tolerance times the gap, all times 4 bound^2 to avoid a division.
template <class Mask, class Real>
SEXTANT_INLINE Mask IsProven(const EigenResidual<Real>& r, const Real& separation,
                             const Real& bound) {
  const Real square = 4.0 * bound * bound;
  const Real tolerance = Max(kMaxEigenvectorError * separation, kResidualRounding * bound * square);
  return r.residual2 * (square * square) <= tolerance * tolerance * r.length2;
}

/// s1 + s2 + s3, from above, with an error of the fourth power of the last step. Typical data needs
/// one step.
SEXTANT_INLINE bool FindLargestRoot(const Quartic<double>& quartic, double bound, double& x,
                                    double& step) {
  constexpr int kMaxIterations = 8;
  x = bound;
  for (int i = 0; i < kMaxIterations; ++i) {
    step = HouseholderStep(quartic, x);
    x -= step;
    if (std::abs(step) <= 1e-3 * bound) return true;
  }
  return false;
}

// Laguerre's step towards the nearest root of a cubic with real roots. It cubes the error, finds a
// nearly triple root from far away, and never oversteps the smallest root from below.
SEXTANT_INLINE double LaguerreStep(double value, double slope, double half_curvature) {
  const double square = 4.0 * slope * slope - 12.0 * value * half_curvature;
  return 3.0 * value / (slope + std::sqrt(Max(square, 0.0)));
}

/// s3, the smallest root of x^3 - e1 x^2 + e2 x - e3, from below, to 1e-8; false where it is so
/// nearly a multiple root that rounding moves it. Typical data needs two steps.
SEXTANT_INLINE bool FindSmallestRoot(double e1, double e2, double e3, double& x) {
  constexpr int kMaxIterations = 4;
  constexpr double kMinSlope = 1e-5;
  for (int i = 0; i < kMaxIterations; ++i) {
    const double value = ((x - e1) * x + e2) * x - e3;
    const double slope = (3.0 * x - 2.0 * e1) * x + e2;
    const double step = LaguerreStep(value, slope, 3.0 * x - e1);
    x -= step;
    // The middle root has a falling slope, and the largest one is above the mean.
    if (!(slope > kMinSlope * e1 * e1 && 3.0 * x < e1)) return false;
    // The next step is about step^3 over the square of the distance to s2, which slope / e1 bounds.
    if (std::abs(step * step * step) * e1 <= 1e-8 * slope * slope) return true;
  }
  return false;
}

/// The maximising rotation, also as a matrix, which callers need to rotate a mean.
struct TraceMaximum {
  Vector4<double> q;
  RotationMatrix<double> matrix;
  double trace = 0.0;
  double mirrored_trace = 0.0;
};

/// None where the residual does not prove the result.
SEXTANT_INLINE std::optional<TraceMaximum> MaximizeTraceByFormula(const CrossMatrix<double>& cross,
                                                                  double bound) {
  constexpr int kMaxRounds = 4;
  const HornMatrix<double> horn = MakeHornMatrix(cross);
  const Invariants<double> v = ComputeInvariants(cross);
  // The step from zero uses the bound in place of e1, so that it need not wait for e1.
  double s3 = -LaguerreStep(-v.product, 0.5 * (bound * bound - v.sum_squares), -bound);
  double e1 = 0.0;
  double step = 0.0;
  if (!FindLargestRoot(CharacteristicPolynomial(v), bound, e1, step)) return std::nullopt;
  // The error of e1 is (step / gap)^4 gap, so the gap computed here may be far too large.
  const double min_separation = kMinSeparation * bound * bound * bound;
  double separation = SeparationOf(v, e1);
  if (!(separation > min_separation)) return std::nullopt;
  bool has_s3 = FindSmallestRoot(e1, 0.5 * (e1 * e1 - v.sum_squares), v.product, s3);
  has_s3 &= 400.0 * std::abs(step) * bound * bound <= separation;
  // A nearly exact eigenvalue gives the vector, whose Rayleigh quotient corrects the eigenvalue.
  for (int round = 0; round < kMaxRounds; ++round) {
    Vector4<double> q = NullVector(horn, e1);
    EigenResidual<double> r = ResidualOf(horn, e1, q);
    e1 += r.shift;
    separation = SeparationOf(v, e1);
    if (!IsProven<bool>(r, separation, bound)) {
      q = WithoutFarParts(q, r, e1);
      r = ResidualOf(horn, e1, q);
      e1 += r.shift;
      separation = SeparationOf(v, e1);
      if (!IsProven<bool>(r, separation, bound)) continue;
    }
    if (!(separation > min_separation)) return std::nullopt;
    const double scale = 1.0 / std::sqrt(r.length2);
    TraceMaximum best;
    best.q = {scale * q.x, scale * q.y, scale * q.z, scale * q.w};
    best.matrix = MakeRotationMatrix(best.q);
    best.trace = e1;
    if (!has_s3) [[unlikely]]
      s3 = SmallestSingularValue(best.matrix, cross);
    best.mirrored_trace = e1 - 2.0 * s3;
    return best;
  }
  return std::nullopt;
}

/// The same by an eigensolver; none where rounding decides the rotation about some axis.
std::optional<MaxTraceRotation> MaximizeTraceByEigensolver(const CrossMatrix<double>& cross,
                                                           double bound);

inline Eigen::Quaterniond ToQuaternion(const Vector4<double>& q) { return {q.w, q.x, q.y, q.z}; }

}  // namespace sextant
