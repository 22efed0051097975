// SPDX-License-Identifier: Apache-2.0
#include "geometry/uncertain_pose.h"

#include <gtest/gtest.h>

#include "base/random.h"

namespace sextant {
namespace {

Vector6d NormalVector6(Random& random) {
  Vector6d v;
  for (int i = 0; i < 6; ++i) v[i] = random.Normal();
  return v;
}

Rigid3d RandomPose(Random& random) { return Perturb({}, NormalVector6(random)); }

// Central differences of a function of a pose, in Perturb's coordinates.
template <class Function>
Matrix6d Differentiate(const Rigid3d& at, const Function& function) {
  constexpr double kStep = 1e-5;
  Matrix6d jacobian;
  for (int i = 0; i < 6; ++i) {
    const Vector6d step = kStep * Vector6d::Unit(i);
    jacobian.col(i) =
        PoseDifference(function(Perturb(at, step)), function(Perturb(at, -step))) / (2.0 * kStep);
  }
  return jacobian;
}

TEST(UncertainPose, JacobiansAreTheDerivatives) {
  constexpr double kTolerance = 1e-8;
  Random random(1);
  for (int i = 0; i < 20; ++i) {
    const Rigid3d left = RandomPose(random);
    const Rigid3d right = RandomPose(random);
    const ProductJacobians by = JacobiansOfProduct(left, right);
    const auto by_left = Differentiate(left, [&](const Rigid3d& pose) { return pose * right; });
    const auto by_right = Differentiate(right, [&](const Rigid3d& pose) { return left * pose; });
    const auto inverse = Differentiate(left, [](const Rigid3d& pose) { return pose.Inverse(); });
    EXPECT_LT((by.by_left - by_left).norm(), kTolerance);
    EXPECT_LT((by.by_right - by_right).norm(), kTolerance);
    EXPECT_LT((JacobianOfInverse(left) - inverse).norm(), kTolerance);
  }
}

TEST(UncertainPose, InverseOfTheInverseIsTheSame) {
  Random random(2);
  Matrix6d root;
  for (int i = 0; i < 6; ++i) root.col(i) = NormalVector6(random);
  const UncertainPose pose{RandomPose(random), root * root.transpose()};
  const UncertainPose back = Inverse(Inverse(pose));
  EXPECT_LT(PoseDifference(back.b_from_a, pose.b_from_a).norm(), 1e-12);
  EXPECT_LT((back.covariance - pose.covariance).norm(), 1e-12 * pose.covariance.norm());
}

}  // namespace
}  // namespace sextant
