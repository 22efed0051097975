// SPDX-License-Identifier: Apache-2.0
#include "solvers/refine/rotation_manifold.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "geometry/random_vectors.h"
#include "geometry/so3.h"

namespace sextant {
namespace {

using Matrix43 = Eigen::Matrix<double, 4, 3, Eigen::RowMajor>;
using Matrix34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

TEST(RotationManifold, PlusTakesFullAnglesAndMinusUndoesIt) {
  const RotationManifold manifold;
  Random random(1);
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Quaterniond q = ExpSo3(NormalVector(random));
    const Eigen::Vector3d delta = 0.5 * NormalVector(random);
    Eigen::Quaterniond sum;
    Eigen::Vector3d back;
    ASSERT_TRUE(manifold.Plus(q.coeffs().data(), delta.data(), sum.coeffs().data()));
    ASSERT_TRUE(manifold.Minus(sum.coeffs().data(), q.coeffs().data(), back.data()));
    EXPECT_LT(RotationDistance(sum, ExpSo3(delta) * q), 1e-14);
    EXPECT_LT((back - delta).norm(), 1e-14);
    EXPECT_NEAR(RotationDistance(sum, q), delta.norm(), 1e-14);
  }
}

TEST(RotationManifold, DerivativesAreThoseOfPlusAndMinus) {
  const RotationManifold manifold;
  Random random(2);
  constexpr double kStep = 1e-6;
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Quaterniond q = ExpSo3(NormalVector(random));
    Matrix43 by_delta;
    Matrix34 by_ambient;
    ASSERT_TRUE(manifold.PlusJacobian(q.coeffs().data(), by_delta.data()));
    ASSERT_TRUE(manifold.MinusJacobian(q.coeffs().data(), by_ambient.data()));
    EXPECT_TRUE((by_ambient * by_delta).isApprox(Eigen::Matrix3d::Identity(), 1e-14));
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(k);
      const Eigen::Vector3d back = -step;
      Eigen::Vector4d above;
      Eigen::Vector4d below;
      manifold.Plus(q.coeffs().data(), step.data(), above.data());
      manifold.Plus(q.coeffs().data(), back.data(), below.data());
      EXPECT_LT(((above - below) / (2.0 * kStep) - by_delta.col(k)).norm(), 1e-9);
    }
  }
}

}  // namespace
}  // namespace sextant
