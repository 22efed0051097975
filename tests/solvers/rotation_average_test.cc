// SPDX-License-Identifier: Apache-2.0
#include "solvers/averaging/rotation_average.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "base/random.h"
#include "geometry/random_vectors.h"
#include "geometry/so3.h"

namespace sextant {
namespace {

using Rotations = std::vector<Eigen::Quaterniond>;

// Rotations scattered by `spread` rad per axis about a common one, with random signs of the
// quaternions.
Rotations Around(const Eigen::Quaterniond& centre, int count, double spread, Random& random) {
  Rotations rotations;
  for (int i = 0; i < count; ++i) {
    Eigen::Quaterniond q = ExpSo3(spread * NormalVector(random)) * centre;
    if (random.Uniform() < 0.5) q.coeffs() = -q.coeffs();
    rotations.push_back(q);
  }
  return rotations;
}

double ChordalCost(const Rotations& rotations, const Eigen::Quaterniond& mean) {
  double cost = 0.0;
  for (const Eigen::Quaterniond& q : rotations) {
    cost += (q.toRotationMatrix() - mean.toRotationMatrix()).squaredNorm();
  }
  return cost;
}

TEST(RotationAverage, ChordalMeanHasTheLeastChordalCost) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const Rotations rotations = Around(ExpSo3(NormalVector(random)), 7, 0.5, random);
    const Eigen::Quaterniond mean = *ChordalMean(rotations);
    const double least = ChordalCost(rotations, mean);
    for (int k = 0; k < 20; ++k) {
      const Eigen::Quaterniond other = ExpSo3(0.01 * NormalVector(random)) * mean;
      EXPECT_GT(ChordalCost(rotations, other), least);
    }
  }
}

TEST(RotationAverage, AllAgreeOnOneRotationRepeated) {
  const Eigen::Quaterniond q = ExpSo3({0.3, -2.0, 1.0});
  Rotations rotations(5, q);
  rotations[3].coeffs() = -q.coeffs();
  EXPECT_LT(RotationDistance(*ChordalMean(rotations), q), 1e-14);
  EXPECT_LT(RotationDistance(*QuaternionSumMean(rotations), q), 1e-14);
  EXPECT_LT(RotationDistance(*OriginalRunningAverage(rotations), q), 1e-14);
}

TEST(RotationAverage, TheMiddleOfTwoIsTheirMean) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1.0, 2.0, -1.0).normalized();
  const Rotations two = {ExpSo3(0.2 * axis), ExpSo3(1.4 * axis)};
  const Eigen::Quaterniond middle = ExpSo3(0.8 * axis);
  EXPECT_LT(RotationDistance(*ChordalMean(two), middle), 1e-14);
  EXPECT_LT(RotationDistance(*QuaternionSumMean(two), middle), 1e-14);
  EXPECT_LT(RotationDistance(*OriginalRunningAverage(two), middle), 1e-14);
}

// The two agree to second order; the third of 0.05 rad is 1.25e-4 rad.
TEST(RotationAverage, ThePapersFormulaIsNearTheChordalMean) {
  Random random(2);
  for (int trial = 0; trial < 50; ++trial) {
    const Rotations rotations = Around(ExpSo3(NormalVector(random)), 20, 0.05, random);
    EXPECT_LT(RotationDistance(*ChordalMean(rotations), *QuaternionSumMean(rotations)), 1.25e-4);
  }
}

TEST(RotationAverage, TheOriginalGivesTheNewestHalfOfTheWeight) {
  Rotations rotations(20, Eigen::Quaterniond::Identity());
  rotations.back() = ExpSo3({0.02, 0.0, 0.0});
  EXPECT_NEAR(LogSo3(*OriginalRunningAverage(rotations)).x(), 0.01, 1e-12);
  EXPECT_NEAR(LogSo3(*ChordalMean(rotations)).x(), 0.001, 1e-7);
}

TEST(RotationAverage, RecoversEachRotationFromTheRunningOnes) {
  Random random(3);
  const Rotations rotations = Around(ExpSo3(NormalVector(random)), 30, 0.3, random);
  for (std::size_t k = 1; k < rotations.size(); ++k) {
    const std::span<const Eigen::Quaterniond> all(rotations);
    const Eigen::Quaterniond before = *OriginalRunningAverage(all.first(k));
    Eigen::Quaterniond after = *OriginalRunningAverage(all.first(k + 1));
    after.coeffs() = -after.coeffs();
    EXPECT_LT(RotationDistance(RecoverOriginalRotation(before, after), rotations[k]), 1e-14);
  }
}

TEST(RotationAverage, RefusesAmbiguousMeansAndNothing) {
  const Rotations opposite = {Eigen::Quaterniond::Identity(), ExpSo3({0.0, 0.0, std::numbers::pi})};
  EXPECT_EQ(ChordalMean(opposite).error().code, ErrorCode::kDegenerate);
  EXPECT_EQ(QuaternionSumMean(opposite).error().code, ErrorCode::kDegenerate);
  EXPECT_EQ(OriginalRunningAverage(opposite).error().code, ErrorCode::kDegenerate);
  Rotations circle;
  for (int i = 0; i < 6; ++i) circle.push_back(ExpSo3({0.0, std::numbers::pi / 3.0 * i, 0.0}));
  EXPECT_EQ(ChordalMean(circle).error().code, ErrorCode::kDegenerate);
  EXPECT_EQ(ChordalMean({}).error().code, ErrorCode::kMissingData);
  EXPECT_EQ(QuaternionSumMean({}).error().code, ErrorCode::kMissingData);
  EXPECT_EQ(OriginalRunningAverage({}).error().code, ErrorCode::kMissingData);
}

}  // namespace
}  // namespace sextant
