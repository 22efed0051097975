// SPDX-License-Identifier: Apache-2.0
#include "eval/metrics/cloud_fusion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace sextant {
namespace {

constexpr double kNoise = 0.004;

// Two walls and the floor of a room corner in the frame with the given pose.
PointCloud Corner(const Rigid3d& frame_from_world, std::uint64_t seed, int points = 6000) {
  Random random(seed);
  PointCloud cloud;
  for (int i = 0; i < points; ++i) {
    Eigen::Vector3d point;
    for (int k = 0; k < 3; ++k) point[k] = random.Uniform(0.0, 2.0);
    point[i % 3] = kNoise * random.Normal();
    cloud.points.push_back(frame_from_world * point);
  }
  return cloud;
}

Rigid3d SomePose() {
  Vector6d delta;
  delta << 0.3, -0.8, 0.2, 0.5, -1.0, 2.0;
  return Perturb({}, delta);
}

TEST(CloudFusion, FusesAllCloudsIntoOneFrame) {
  PointCloud a = Corner({}, 1, 30);
  PointCloud b = Corner(SomePose().Inverse(), 1, 30);
  a.points[4].setConstant(std::nan(""));
  a.intensity.assign(30, 1.0F);
  b.intensity.assign(30, 2.0F);
  const std::vector<PointCloud> clouds = {a, b};
  const std::vector<Rigid3d> poses = {{}, SomePose()};
  const PointCloud fused = FuseClouds(clouds, poses);
  ASSERT_EQ(fused.points.size(), 59U);
  ASSERT_EQ(fused.intensity.size(), 59U);
  EXPECT_EQ(fused.intensity[28], 1.0F);
  EXPECT_EQ(fused.intensity[29], 2.0F);
  EXPECT_LT((fused.points[0] - fused.points[29]).norm(), 1e-12);
  EXPECT_LT((fused.points[28] - fused.points[58]).norm(), 1e-12);

  const std::vector<PointCloud> one_without = {a, Corner({}, 2, 3)};
  EXPECT_TRUE(FuseClouds(one_without, poses).intensity.empty());
}

// The position of a patch of 12 points has a standard error of about noise / sqrt(12) at its
// centre, so the sigma of the distance is about noise sqrt(1 + 1/12) and its median 0.6745 of that.
TEST(CloudFusion, DistancesAreTheNoiseUnderTheTruePose) {
  const PointCloud a = Corner({}, 1);
  const PointCloud b = Corner(SomePose(), 2);
  const CloudAgreement agreement = CompareClouds(a, SomePose(), ReferenceCloud(b));
  EXPECT_EQ(agreement.points, 6000);
  EXPECT_GT(agreement.Overlap(), 0.9);
  EXPECT_NEAR(agreement.median_m, 0.6745 * kNoise * std::sqrt(13.0 / 12.0), 0.1 * kNoise);
}

TEST(CloudFusion, MeasuresTheShiftOfAWall) {
  const PointCloud a = Corner({}, 1);
  const ReferenceCloud b(Corner({}, 2));
  for (const double shift : {0.03, 0.06}) {
    const Rigid3d moved{Eigen::Quaterniond::Identity(), Eigen::Vector3d::Constant(shift)};
    const CloudAgreement agreement = CompareClouds(a, moved, b);
    EXPECT_NEAR(agreement.median_m, shift, kNoise);
  }
}

TEST(CloudFusion, ReportsCloudsWithoutOverlap) {
  const Rigid3d far{Eigen::Quaterniond::Identity(), {50.0, 0.0, 0.0}};
  const CloudAgreement agreement = CompareClouds(Corner({}, 1), far, ReferenceCloud(Corner({}, 2)));
  EXPECT_EQ(agreement.compared, 0);
  EXPECT_TRUE(std::isnan(agreement.median_m));
  EXPECT_EQ(CompareClouds({}, far, ReferenceCloud({})).points, 0);
}

}  // namespace
}  // namespace sextant
