// SPDX-License-Identifier: Apache-2.0
#include "geometry/symmetric.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "geometry/so3.h"

namespace sextant {
namespace {

template <int kSize>
SquareMatrix<kSize> RandomMatrix(Random& random, int size = kSize) {
  return SquareMatrix<kSize>::NullaryExpr(size, size, [&](auto, auto) { return random.Normal(); });
}

// Positive definite, eigenvalues about 1 to 4 * kSize.
template <int kSize>
SquareMatrix<kSize> RandomCovariance(Random& random, int size = kSize) {
  const SquareMatrix<kSize> root = RandomMatrix<kSize>(random, size);
  return root * root.transpose() + SquareMatrix<kSize>::Identity(size, size);
}

template <int kSize>
void ExpectEigen(int size) {
  Random random(1);
  const SquareMatrix<kSize> whole = RandomCovariance<kSize>(random, size);
  const SquareMatrix<kSize> lower = whole.template triangularView<Eigen::Lower>();
  const SymmetricEigen<kSize> eigen = EigenOf(lower);
  for (int i = 1; i < size; ++i) EXPECT_LT(eigen.values(i - 1), eigen.values(i));
  EXPECT_LT((eigen.vectors.transpose() * eigen.vectors - SquareMatrix<kSize>::Identity(size, size))
                .norm(),
            1e-13);
  EXPECT_LT((eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.transpose() - whole).norm(),
            1e-13 * whole.norm());
}

TEST(Symmetric, EigenvaluesAscendAndVectorsComposeTheMatrix) {
  ExpectEigen<2>(2);
  ExpectEigen<3>(3);
  ExpectEigen<4>(4);
  ExpectEigen<6>(6);
  ExpectEigen<Eigen::Dynamic>(9);
}

TEST(Symmetric, SolutionFulfilsTheEquations) {
  Random random(2);
  const Matrix6d matrix = RandomCovariance<6>(random);
  const Vector6d right = RandomMatrix<6>(random).col(0);
  EXPECT_LT((matrix * SolveSymmetric(matrix, right) - right).norm(), 1e-12);
  const Eigen::MatrixXd large = RandomCovariance<Eigen::Dynamic>(random, 20);
  const Eigen::VectorXd long_right = large.col(0);
  EXPECT_LT((SolveSymmetric(large, long_right) - Eigen::VectorXd::Unit(20, 0)).norm(), 1e-12);
}

// A direction without information stays where it is; the others are solved.
TEST(Symmetric, SolvesASemidefiniteSystem) {
  Random random(5);
  const Eigen::Matrix<double, 6, 3> root = RandomMatrix<6>(random).leftCols<3>();
  const Matrix6d matrix = root * root.transpose();
  const Vector6d right = matrix * RandomMatrix<6>(random).col(0);
  EXPECT_LT((matrix * SolveSymmetric(matrix, right) - right).norm(), 1e-9);
  EXPECT_TRUE(SolveSymmetric<6>(Matrix6d::Zero(), right).isZero());
}

// Units may differ by any factor: only a matrix that is singular in every unit has no inverse.
TEST(Symmetric, InverseDoesNotDependOnUnits) {
  Random random(3);
  const Matrix6d matrix = RandomCovariance<6>(random);
  Vector6d unit;
  unit << 1e-9, 1e-9, 1e-9, 1e7, 1e7, 1e7;
  const std::optional<Matrix6d> plain = InvertSymmetric(matrix);
  const std::optional<Matrix6d> scaled =
      InvertSymmetric<6>(unit.asDiagonal() * matrix * unit.asDiagonal());
  ASSERT_TRUE(plain && scaled);
  EXPECT_LT((matrix * *plain - Matrix6d::Identity()).norm(), 1e-12);
  const Matrix6d rescaled = unit.asDiagonal() * *scaled * unit.asDiagonal();
  EXPECT_LT((rescaled - *plain).norm(), 1e-12);
  EXPECT_EQ(*plain, plain->transpose());
}

TEST(Symmetric, ASingularMatrixHasNoInverse) {
  Random random(4);
  Matrix6d rank_five = Matrix6d::Zero();
  for (int i = 0; i < 5; ++i) {
    const Vector6d row = RandomMatrix<6>(random).col(0);
    rank_five += row * row.transpose();
  }
  EXPECT_FALSE(InvertSymmetric(rank_five));
  EXPECT_FALSE(InvertSymmetric<6>(Matrix6d::Zero()));
  EXPECT_FALSE(InvertSymmetric<6>(-Matrix6d::Identity()));
  EXPECT_FALSE(InvertSymmetric<Eigen::Dynamic>(rank_five));
  Matrix6d unknown = Matrix6d::Identity();
  unknown(2, 2) = std::nan("");
  EXPECT_FALSE(InvertSymmetric(unknown));
}

// The mean of 2000 draws from N(0, C) has the standard error sqrt(2 * 6 / 2000) = 0.08.
TEST(Symmetric, SquaredMahalanobisIsChiSquared) {
  constexpr int kDraws = 2000;
  Random random(5);
  const Matrix6d root = RandomMatrix<6>(random) + 4.0 * Matrix6d::Identity();
  double mean = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const Vector6d error =
        root * Vector6d::NullaryExpr([&](Eigen::Index) { return random.Normal(); });
    mean += SquaredMahalanobis<6>(error, root * root.transpose()) / kDraws;
  }
  EXPECT_NEAR(mean, 6.0, 5.0 * 0.08);
  EXPECT_DOUBLE_EQ(SquaredMahalanobis<3>({1.0, 0.0, -2.0}, 4.0 * Eigen::Matrix3d::Identity()),
                   1.25);
}

}  // namespace
}  // namespace sextant
