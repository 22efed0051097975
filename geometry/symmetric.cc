// SPDX-License-Identifier: Apache-2.0
#include "geometry/symmetric.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace sextant {

template <int kSize>
SymmetricEigen<kSize> EigenOf(const SquareMatrix<kSize>& symmetric) {
  const Eigen::SelfAdjointEigenSolver<SquareMatrix<kSize>> eigen(symmetric);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

namespace {

// L D L^T of a positive semi-definite matrix scaled to a unit diagonal. Such a matrix needs no
// pivoting, and for six rows Eigen's factorisation takes four times as long.
template <int kSize>
struct ScaledFactor {
  ColumnVector<kSize> scale;
  SquareMatrix<kSize> l;          ///< Below the diagonal; the diagonal is 1.
  ColumnVector<kSize> inverse_d;  ///< 0 where the pivot vanishes.
  bool is_singular = false;
};

template <int kSize>
ScaledFactor<kSize> FactorScaled(const SquareMatrix<kSize>& matrix) {
  // Smaller pivots of the unit-diagonal matrix are rounding.
  constexpr double kMinPivot = 1e-13;
  const Eigen::Index size = matrix.rows();
  ScaledFactor<kSize> factor{ColumnVector<kSize>(size), {}, ColumnVector<kSize>(size)};
  for (Eigen::Index i = 0; i < size; ++i) {
    factor.scale[i] = matrix(i, i) > 0.0 ? 1.0 / std::sqrt(matrix(i, i)) : 0.0;
  }
  SquareMatrix<kSize>& l = factor.l;
  l = factor.scale.asDiagonal() * matrix * factor.scale.asDiagonal();
  SquareMatrix<kSize> ld(size, size);  // l(i, k) d(k)
  for (Eigen::Index j = 0; j < size; ++j) {
    for (Eigen::Index i = j; i < size; ++i) {
      double d = l(i, j);
      for (Eigen::Index k = 0; k < j; ++k) d -= l(i, k) * ld(j, k);
      ld(i, j) = d;
    }
    const bool vanishes = !(ld(j, j) > kMinPivot);
    factor.is_singular |= vanishes;
    factor.inverse_d[j] = vanishes ? 0.0 : 1.0 / ld(j, j);
    for (Eigen::Index i = j + 1; i < size; ++i) l(i, j) = ld(i, j) * factor.inverse_d[j];
  }
  return factor;
}

}  // namespace

template <int kSize>
ColumnVector<kSize> SolveSymmetric(const SquareMatrix<kSize>& symmetric,
                                   const ColumnVector<kSize>& right) {
  const ScaledFactor<kSize> factor = FactorScaled<kSize>(symmetric);
  const Eigen::Index size = symmetric.rows();
  ColumnVector<kSize> x = factor.scale.cwiseProduct(right);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index k = 0; k < i; ++k) x[i] -= factor.l(i, k) * x[k];
  }
  x = x.cwiseProduct(factor.inverse_d);
  for (Eigen::Index i = size - 1; i >= 0; --i) {
    for (Eigen::Index k = i + 1; k < size; ++k) x[i] -= factor.l(k, i) * x[k];
  }
  return x.cwiseProduct(factor.scale);
}

template <int kSize>
std::optional<SquareMatrix<kSize>> InvertSymmetric(const SquareMatrix<kSize>& information) {
  const ScaledFactor<kSize> factor = FactorScaled<kSize>(information);
  if (factor.is_singular || !factor.scale.allFinite()) return std::nullopt;
  const Eigen::Index size = information.rows();
  SquareMatrix<kSize> lower = SquareMatrix<kSize>::Identity(size, size);  // L^-1
  for (Eigen::Index j = 0; j < size; ++j) {
    for (Eigen::Index i = j + 1; i < size; ++i) {
      double sum = factor.l(i, j);
      for (Eigen::Index k = j + 1; k < i; ++k) sum += factor.l(i, k) * lower(k, j);
      lower(i, j) = -sum;
    }
  }
  SquareMatrix<kSize> inverse(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      double sum = 0.0;
      for (Eigen::Index k = i; k < size; ++k)
        sum += lower(k, i) * lower(k, j) * factor.inverse_d[k];
      inverse(i, j) = inverse(j, i) = sum * factor.scale[i] * factor.scale[j];
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
template SymmetricEigen<Eigen::Dynamic> EigenOf(const SquareMatrix<Eigen::Dynamic>&);

// No inner loop decomposes six rows, and a solver of fixed size takes 10 s to compile.
template <>
SymmetricEigen<6> EigenOf(const SquareMatrix<6>& symmetric) {
  const SymmetricEigen<Eigen::Dynamic> eigen = EigenOf<Eigen::Dynamic>(symmetric);
  return {eigen.values, eigen.vectors};
}

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
