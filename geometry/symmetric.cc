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

template <int kSize>
std::optional<SquareMatrix<kSize>> InvertSymmetric(const SquareMatrix<kSize>& information) {
  // Pivots of the unit-diagonal matrix below this are rounding.
  constexpr double kMinPivot = 1e-13;
  const ColumnVector<kSize> scale = information.diagonal().cwiseSqrt().cwiseInverse();
  if (!scale.allFinite()) return std::nullopt;
  const SquareMatrix<kSize> unit = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::LDLT<SquareMatrix<kSize>> factor(unit);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > kMinPivot)) {
    return std::nullopt;
  }
  const auto size = information.rows();
  const SquareMatrix<kSize> inverse =
      scale.asDiagonal() * factor.solve(SquareMatrix<kSize>::Identity(size, size)).eval() *
      scale.asDiagonal();
  return SquareMatrix<kSize>(0.5 * (inverse + inverse.transpose()));
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
