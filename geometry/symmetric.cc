// SPDX-License-Identifier: Apache-2.0
#include "geometry/symmetric.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace sextant {

template <int kSize>
SymmetricEigen<kSize> EigenOf(const SquareMatrix<kSize>& symmetric) {
  const Eigen::SelfAdjointEigenSolver<SquareMatrix<kSize>> eigen(symmetric);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

template <int kSize>
ColumnVector<kSize> SolveSymmetric(const SquareMatrix<kSize>& symmetric,
                                   const ColumnVector<kSize>& right) {
  return symmetric.ldlt().solve(right);
}

// L D L^T of the matrix scaled to a unit diagonal. For six rows Eigen's takes four times as long.
template <int kSize>
std::optional<SquareMatrix<kSize>> InvertSymmetric(const SquareMatrix<kSize>& information) {
  using Matrix = SquareMatrix<kSize>;
  // Smaller pivots of the unit-diagonal matrix are rounding.
  constexpr double kMinPivot = 1e-13;
  const ColumnVector<kSize> scale = information.diagonal().cwiseSqrt().cwiseInverse();
  if (!scale.allFinite()) return std::nullopt;
  const Eigen::Index size = information.rows();
  Matrix l = scale.asDiagonal() * information * scale.asDiagonal();
  Matrix ld(size, size);  // l(i, k) d(k)
  ColumnVector<kSize> inverse_d(size);
  for (Eigen::Index j = 0; j < size; ++j) {
    for (Eigen::Index i = j; i < size; ++i) {
      double d = l(i, j);
      for (Eigen::Index k = 0; k < j; ++k) d -= l(i, k) * ld(j, k);
      ld(i, j) = d;
    }
    if (!(ld(j, j) > kMinPivot)) return std::nullopt;
    inverse_d[j] = 1.0 / ld(j, j);
    for (Eigen::Index i = j + 1; i < size; ++i) l(i, j) = ld(i, j) * inverse_d[j];
  }
  Matrix lower = Matrix::Identity(size, size);  // L^-1
  for (Eigen::Index j = 0; j < size; ++j) {
    for (Eigen::Index i = j + 1; i < size; ++i) {
      double sum = l(i, j);
      for (Eigen::Index k = j + 1; k < i; ++k) sum += l(i, k) * lower(k, j);
      lower(i, j) = -sum;
    }
  }
  Matrix inverse(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      double sum = 0.0;
      for (Eigen::Index k = i; k < size; ++k) sum += lower(k, i) * lower(k, j) * inverse_d[k];
      inverse(i, j) = inverse(j, i) = sum * scale[i] * scale[j];
    }
  }
  return inverse;
}

template <int kSize>
double SquaredMahalanobis(const ColumnVector<kSize>& error, const SquareMatrix<kSize>& covariance) {
  return error.dot(SolveSymmetric<kSize>(covariance, error));
}

template SymmetricEigen<2> EigenOf(const SquareMatrix<2>&);
template SymmetricEigen<3> EigenOf(const SquareMatrix<3>&);
template SymmetricEigen<4> EigenOf(const SquareMatrix<4>&);
template SymmetricEigen<6> EigenOf(const SquareMatrix<6>&);
template SymmetricEigen<Eigen::Dynamic> EigenOf(const SquareMatrix<Eigen::Dynamic>&);

template ColumnVector<3> SolveSymmetric(const SquareMatrix<3>&, const ColumnVector<3>&);
template ColumnVector<6> SolveSymmetric(const SquareMatrix<6>&, const ColumnVector<6>&);
template ColumnVector<Eigen::Dynamic> SolveSymmetric(const SquareMatrix<Eigen::Dynamic>&,
                                                     const ColumnVector<Eigen::Dynamic>&);

template std::optional<SquareMatrix<6>> InvertSymmetric(const SquareMatrix<6>&);
template std::optional<SquareMatrix<Eigen::Dynamic>> InvertSymmetric(
    const SquareMatrix<Eigen::Dynamic>&);

template double SquaredMahalanobis(const ColumnVector<3>&, const SquareMatrix<3>&);
template double SquaredMahalanobis(const ColumnVector<6>&, const SquareMatrix<6>&);
template double SquaredMahalanobis(const ColumnVector<8>&, const SquareMatrix<8>&);

}  // namespace sextant
