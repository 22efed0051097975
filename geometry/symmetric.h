// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

namespace sextant {

// Operations on symmetric matrices, compiled once for the sizes that occur: Eigen's decompositions
// cost seconds of compile time in every unit that has one. Only the lower triangle of a matrix is
// read.

template <int kSize>
using SquareMatrix = Eigen::Matrix<double, kSize, kSize>;
template <int kSize>
using ColumnVector = Eigen::Matrix<double, kSize, 1>;

template <int kSize>
struct SymmetricEigen {
  ColumnVector<kSize> values;   ///< Ascending.
  SquareMatrix<kSize> vectors;  ///< In columns, of unit length.
};

/// Sizes 2, 3, 4, 6 and any (Eigen::Dynamic).
template <int kSize>
SymmetricEigen<kSize> EigenOf(const SquareMatrix<kSize>& symmetric);

/// Solves symmetric x = right for a positive semi-definite matrix. Where it is singular to 1e-13
/// (after scaling to a unit diagonal), components without information are 0. Sizes 3, 6 and any.
template <int kSize>
ColumnVector<kSize> SolveSymmetric(const SquareMatrix<kSize>& symmetric,
                                   const ColumnVector<kSize>& right);

/// The inverse of a symmetric positive definite matrix; none where it is singular to 1e-13 after
/// scaling to a unit diagonal, so that the choice of units does not matter. Sizes 6 and any.
template <int kSize>
std::optional<SquareMatrix<kSize>> InvertSymmetric(const SquareMatrix<kSize>& information);

/// error^T covariance^-1 error: for a Gaussian error chi-square distributed, with the size as mean.
/// Sizes 3, 6 and 8.
template <int kSize>
double SquaredMahalanobis(const ColumnVector<kSize>& error, const SquareMatrix<kSize>& covariance);

}  // namespace sextant
