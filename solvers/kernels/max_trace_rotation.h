// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

namespace sextant {

/// The maximum of trace(R * cross) over rotations, and over reflections for comparison.
struct MaxTraceRotation {
  Eigen::Quaterniond rotation;  ///< The maximiser, unit length.
  double trace = 0.0;  ///< s1 + s2 + d s3 of the singular values; d the sign of det(cross).
  double mirrored_trace = 0.0;  ///< s1 + s2 - d s3, to 1e-7 of trace_bound.
};

/// argmax over R in SO(3) of trace(R * cross): Wahba's problem, the core of every fit of a rotation
/// to vectors.
///
/// The unit quaternion of R is the eigenvector of the largest eigenvalue of Horn's symmetric 4x4
/// matrix K. That eigenvalue is the largest root of x^4 - 2 |cross|^2 x^2 - 8 det(cross) x + det K,
/// found by Householder's iteration from above, and the eigenvector is a column of the adjugate of
/// K - x I (Horn 1987, JOSA A 4; Theobald 2005, Acta Cryst. A61), corrected by its Rayleigh
/// quotient. Where the residual K q - x q does not prove the result to rounding, an eigensolver
/// decides.
///
/// `trace_bound` > 0 is at least the maximum: half of sum w (|a|^2 + |b|^2) for
/// cross = sum w a b^T. None where the two largest eigenvalues are closer than 1e-10 of it, that
/// is, where a rotation about some axis changes nothing.
std::optional<MaxTraceRotation> MaximizeTrace(const Eigen::Matrix3d& cross, double trace_bound);

}  // namespace sextant
