// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <optional>

namespace sextant {

/// The inverse of a symmetric positive definite matrix; none where it is singular to 1e-13 after
/// scaling to a unit diagonal, so that the choice of units does not matter.
template <class Matrix>
std::optional<Matrix> InvertSymmetric(const Matrix& information) {
  // Pivots of the unit-diagonal matrix below this are rounding.
  constexpr double kMinPivot = 1e-13;
  using Vector = Eigen::Matrix<double, Matrix::RowsAtCompileTime, 1>;
  const Vector scale = information.diagonal().cwiseSqrt().cwiseInverse();
  if (!scale.allFinite()) return std::nullopt;
  const Matrix unit = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::LDLT<Matrix> factor(unit);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > kMinPivot)) {
    return std::nullopt;
  }
  const auto size = information.rows();
  const Matrix inverse =
      scale.asDiagonal() * factor.solve(Matrix::Identity(size, size)).eval() * scale.asDiagonal();
  return Matrix(0.5 * (inverse + inverse.transpose()));
}

}  // namespace sextant
