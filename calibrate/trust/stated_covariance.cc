// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/stated_covariance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/symmetric.h"

namespace sextant {
namespace {

// Radians and metres are scaled alike, so that the eigenvalues are comparable.
Vector6d Scale(const Matrix6d& matrix) { return matrix.diagonal().cwiseMax(1e-300).cwiseSqrt(); }

Matrix6d Symmetric(const Matrix6d& matrix) { return 0.5 * (matrix + matrix.transpose()); }

Matrix6d Power(const SymmetricEigen<6>& eigen, double power) {
  const Vector6d values = eigen.values.cwiseMax(1e-300).array().pow(power);
  return eigen.vectors * values.asDiagonal() * eigen.vectors.transpose();
}

// The eigenvalues and vectors of a matrix with a unit diagonal after scaling; none where singular.
std::optional<SymmetricEigen<6>> ScaledEigen(const Matrix6d& matrix, const Vector6d& scale) {
  constexpr double kSmallestEigenvalue = 1e-9;
  const Vector6d inverse = scale.cwiseInverse();
  const SymmetricEigen<6> eigen =
      EigenOf<6>(Symmetric(inverse.asDiagonal() * matrix * inverse.asDiagonal()));
  if (!(eigen.values[0] > kSmallestEigenvalue)) return std::nullopt;
  return eigen;
}

}  // namespace

double OneSigmaOfT(int degrees) {
  constexpr std::array kFirst = {1.837, 1.321, 1.197, 1.142, 1.111, 1.091, 1.077, 1.067};
  const int n = std::max(degrees, 1);
  if (n <= static_cast<int>(kFirst.size())) return kFirst[static_cast<std::size_t>(n - 1)];
  return 1.0 + 0.5 / (n - 0.5);  // The first term of the expansion in 1 / n.
}

std::optional<Matrix6d> StatedCovariance(const std::optional<Matrix6d>& solver,
                                         const ViewScatter& scatter) {
  const double t = OneSigmaOfT(scatter.views - 1);
  if (!solver) {
    if (!scatter.bootstrap) return std::nullopt;
    return Matrix6d(t * t * *scatter.bootstrap);
  }
  const double ratio = t * scatter.jackknife_over_solver.value_or(0.0);
  const double excess = std::max(1.0, ratio * ratio);
  if (!scatter.bootstrap) return Matrix6d(excess * *solver);
  const Vector6d scale = Scale(*solver);
  const std::optional<SymmetricEigen<6>> own = ScaledEigen(*solver, scale);
  if (!own) return Matrix6d(excess * *solver);
  // The solver's covariance is root root^T.
  const Vector6d lengths = own->values.cwiseSqrt();
  const Matrix6d root = scale.asDiagonal() * own->vectors * lengths.asDiagonal();
  const Matrix6d to_white = lengths.cwiseInverse().asDiagonal() * own->vectors.transpose() *
                            scale.cwiseInverse().asDiagonal();
  const SymmetricEigen<6> eigen =
      EigenOf<6>(Symmetric(to_white * *scatter.bootstrap * to_white.transpose()));
  const Matrix6d axes = root * eigen.vectors;
  const Vector6d values = eigen.values.cwiseMax(excess);
  return Symmetric(axes * values.asDiagonal() * axes.transpose());
}

std::optional<Matrix6d> CongruenceTo(const Matrix6d& from, const Matrix6d& to) {
  const Vector6d scale = Scale(from);
  const std::optional<SymmetricEigen<6>> eigen = ScaledEigen(from, scale);
  if (!eigen) return std::nullopt;
  // T = from^-1/2 (from^1/2 to from^1/2)^1/2 from^-1/2, with both matrices scaled.
  const Matrix6d root = Power(*eigen, 0.5);
  const Matrix6d inverse = Power(*eigen, -0.5);
  const Matrix6d scaled = scale.asDiagonal() * to * scale.asDiagonal();
  const Matrix6d inner = Power(EigenOf<6>(Symmetric(root * scaled * root)), 0.5);
  const Vector6d back = scale.cwiseInverse();
  return Symmetric(back.asDiagonal() * (inverse * inner * inverse) * back.asDiagonal());
}

}  // namespace sextant
