// SPDX-License-Identifier: Apache-2.0
#include "geometry/rigid3d.h"

#include <gtest/gtest.h>

#include <numbers>

#include "base/random.h"

namespace sextant {
namespace {

Eigen::Vector3d RandomVector(Random& random, double scale) {
  Eigen::Vector3d v;
  for (int i = 0; i < 3; ++i) v[i] = scale * random.Normal();
  return v;
}

// The properties hold at the identity, near it, where the series take over, and far away.
class So3 : public testing::TestWithParam<double> {};

TEST_P(So3, LogInvertsExp) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    Eigen::Vector3d phi = RandomVector(random, GetParam());
    if (phi.norm() >= std::numbers::pi) phi *= 3.0 / phi.norm();
    EXPECT_LT((LogSo3(ExpSo3(phi)) - phi).norm(), 1e-14 + 1e-13 * phi.norm());
  }
}

TEST_P(So3, ExpActsAsTheSeriesOfHat) {
  Random random(2);
  const Eigen::Vector3d phi = RandomVector(random, GetParam());
  Eigen::Matrix3d series = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d term = Eigen::Matrix3d::Identity();
  for (int k = 1; k < 60; ++k) {
    term = term * Hat(phi) / k;
    series += term;
  }
  EXPECT_LT((ExpSo3(phi).toRotationMatrix() - series).norm(), 1e-12);
}

TEST_P(So3, LeftJacobianIsTheDerivativeOfExp) {
  Random random(3);
  const Eigen::Vector3d phi = RandomVector(random, GetParam());
  const Eigen::Vector3d d = RandomVector(random, 1e-6);
  const Eigen::Vector3d moved = LogSo3(ExpSo3(phi + d) * ExpSo3(phi).conjugate());
  EXPECT_LT((moved - LeftJacobianSo3(phi) * d).norm(), 1e-10);
}

INSTANTIATE_TEST_SUITE_P(Scales, So3, testing::Values(0.0, 1e-9, 1e-5, 1e-4, 1e-2, 1.0, 2.0));

TEST(So3, LogOfHalfATurnHasLengthPi) {
  EXPECT_NEAR(LogSo3(Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0)).norm(), std::numbers::pi, 1e-15);
}

TEST(So3, RotationBetweenTurnsOneDirectionToTheOther) {
  Random random(6);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d from = RandomVector(random, 1.0);
    const Eigen::Vector3d to = RandomVector(random, 1.0);
    const Eigen::Quaterniond turn = RotationBetween(from, to);
    EXPECT_LT(((turn * from).normalized() - to.normalized()).norm(), 1e-14);
    // The smallest rotation is about the axis perpendicular to both.
    EXPECT_LT(std::abs(LogSo3(turn).dot(from.normalized())), 1e-14);
    const Eigen::Vector3d back = RotationBetween(from, -2.0 * from) * from;
    EXPECT_LT((back + from).norm(), 1e-14 * from.norm());
  }
}

TEST(EulerZyx, RoundTripsAlsoAtGimbalLock) {
  Random random(4);
  for (int i = 0; i < 200; ++i) {
    const EulerZyx euler{random.Uniform(-3, 3),
                         i % 4 == 0 ? std::numbers::pi / 2 : random.Uniform(-1.5, 1.5),
                         random.Uniform(-3, 3)};
    const Eigen::Quaterniond rotation = FromEulerZyx(euler);
    EXPECT_LT(RotationDistance(FromEulerZyx(ToEulerZyx(rotation)), rotation), 1e-7);
  }
}

TEST(Rigid3d, ComposesAndInverts) {
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const Rigid3d b_from_a{ExpSo3(RandomVector(random, 1.0)), RandomVector(random, 2.0)};
    const Rigid3d c_from_b{ExpSo3(RandomVector(random, 1.0)), RandomVector(random, 2.0)};
    const Eigen::Vector3d p = RandomVector(random, 3.0);
    EXPECT_LT((c_from_b * b_from_a * p - c_from_b * (b_from_a * p)).norm(), 1e-13);
    EXPECT_LT((b_from_a.Inverse() * (b_from_a * p) - p).norm(), 1e-13);
    EXPECT_LT(((b_from_a.Matrix() * p.homogeneous()).head<3>() - b_from_a * p).norm(), 1e-13);
  }
}

TEST(Rigid3d, PoseDifferenceInvertsPerturb) {
  Random random(6);
  const Rigid3d pose{ExpSo3(RandomVector(random, 1.0)), RandomVector(random, 2.0)};
  Vector6d delta;
  delta << 0.1, -0.2, 0.05, 1.0, 2.0, -3.0;
  EXPECT_LT((PoseDifference(Perturb(pose, delta), pose) - delta).norm(), 1e-14);
}

}  // namespace
}  // namespace sextant
