// SPDX-License-Identifier: Apache-2.0
#include "solvers/kabsch.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "geometry/so3.h"

namespace sextant {
namespace {

using Points = std::vector<Eigen::Vector3d>;

Points RandomPoints(int count, Random& random) {
  Points points(static_cast<std::size_t>(count));
  for (Eigen::Vector3d& p : points) {
    for (int k = 0; k < 3; ++k) p[k] = random.Normal();
  }
  return points;
}

Points Moved(const Rigid3d& b_from_a, const Points& points) {
  Points moved;
  for (const Eigen::Vector3d& p : points) moved.push_back(b_from_a * p);
  return moved;
}

TEST(Kabsch, RecoversExactPosesFarFromTheOrigin) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const Rigid3d truth{ExpSo3({random.Normal(), random.Normal(), random.Normal()}),
                        {100.0, -200.0, 300.0}};
    const Points a = RandomPoints(3 + trial % 20, random);
    const Expected<KabschFit> fit = FitKabsch(Moved(truth, a), a);
    ASSERT_TRUE(fit) << fit.error().message;
    EXPECT_LT(RotationDistance(fit->b_from_a.rotation, truth.rotation), 1e-8);
    EXPECT_LT((fit->b_from_a.translation - truth.translation).norm(), 1e-8);
  }
}

TEST(Kabsch, RefusesCollinearCoincidentAndMirroredSets) {
  Random random(2);
  const Points a = RandomPoints(8, random);
  Points line = a;
  for (Eigen::Vector3d& p : line) p = Eigen::Vector3d(1, 2, 3) + p.x() * Eigen::Vector3d(1, 1, 0);
  EXPECT_EQ(FitKabsch(a, line).error().code, ErrorCode::kDegenerate);
  EXPECT_EQ(FitKabsch(line, a).error().code, ErrorCode::kDegenerate);
  const Points same(8, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(FitKabsch(same, a).error().code, ErrorCode::kDegenerate);
  Points mirrored = a;
  for (Eigen::Vector3d& p : mirrored) p.x() = -p.x();
  EXPECT_EQ(FitKabsch(mirrored, a).error().code, ErrorCode::kMirrored);
  EXPECT_EQ(
      FitKabsch(Points(a.begin(), a.begin() + 2), Points(a.begin(), a.begin() + 2)).error().code,
      ErrorCode::kTooFewPairs);
}

TEST(Kabsch, WeightsCountAsRepetitions) {
  Random random(3);
  Points a = RandomPoints(6, random);
  Points b = RandomPoints(6, random);
  const std::vector<double> weights = {1, 1, 2, 1, 3, 1};
  const Expected<KabschFit> weighted = FitKabsch(b, a, weights);
  for (const int i : {2, 4, 4}) {
    a.push_back(a[static_cast<std::size_t>(i)]);
    b.push_back(b[static_cast<std::size_t>(i)]);
  }
  const Expected<KabschFit> repeated = FitKabsch(b, a);
  ASSERT_TRUE(weighted && repeated);
  EXPECT_LT(RotationDistance(weighted->b_from_a.rotation, repeated->b_from_a.rotation), 1e-12);
  EXPECT_NEAR(weighted->sum_squares, repeated->sum_squares, 1e-12);
}

}  // namespace
}  // namespace sextant
