// SPDX-License-Identifier: Apache-2.0
#include "io/problems/acfr_poses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "solvers/kernels/kabsch.h"
#include "support/bad_text.h"
#include "support/real_data.h"

namespace sextant {
namespace {

using test::BadText;

double KabschRmse(std::span<const Pair3d3d> pairs, Eigen::Vector3d* translation = nullptr) {
  const PointSets points = PointsOf(pairs);
  const Expected<KabschFit> fit = FitKabsch(points.in_cam, points.in_lidar);
  if (translation != nullptr) *translation = fit->b_from_a.translation;
  return std::sqrt(fit->sum_squares / static_cast<double>(pairs.size()));
}

TEST(AcfrPoses, ReadsTheRealFile) {
  SEXTANT_REAL_DATA(path, "acfr_vlp16/poses.csv");
  const auto poses = ReadAcfrPoses(path);
  ASSERT_TRUE(poses) << poses.error().message;
  ASSERT_EQ(poses->size(), 40U);
  const AcfrPose& first = poses->front();
  EXPECT_EQ(first.id, 1);
  EXPECT_LT((first.in_cam.centre_m - Eigen::Vector3d(-0.553382, -0.330019, 1.51424)).norm(), 1e-12);
  EXPECT_EQ(first.in_lidar.normal, Eigen::Vector3d(-0.950503, -0.247479, -0.18788));
  EXPECT_NEAR(first.in_lidar.corners_m[3].z(), -0.584785, 1e-12);
  EXPECT_NEAR(first.widths_m[1], 0.621673, 1e-12);
  EXPECT_EQ(first.distance_m, 1.69713);
  EXPECT_EQ(poses->back().id, 40);
}

TEST(AcfrPoses, SolvedOrderMakesOneProblemOfAllPoses) {
  SEXTANT_REAL_DATA(path, "acfr_vlp16/poses.csv");
  const auto poses = ReadAcfrPoses(path);
  ASSERT_TRUE(poses);
  const auto corners = ProblemFromAcfrPoses(*poses);
  ASSERT_TRUE(corners) << corners.error().message;
  ASSERT_EQ(corners->pairs_3d3d.size(), 160U);
  std::vector<Pair3d3d> without_relabelled;
  for (const Pair3d3d& pair : corners->pairs_3d3d) {
    const std::set<int> relabelled = {7, 16, 17, 30, 31, 32};
    if (!relabelled.contains(pair.id.view + 1)) without_relabelled.push_back(pair);
  }
  ASSERT_EQ(without_relabelled.size(), 136U);
  Eigen::Vector3d translation;
  EXPECT_NEAR(KabschRmse(without_relabelled, &translation), 0.0178, 5e-5);
  EXPECT_LT((translation - Eigen::Vector3d(0.01077, -0.16260, -0.08668)).norm(), 2e-5);
  const auto with_centres = ProblemFromAcfrPoses(*poses, AcfrPoints::kCornersAndCentres);
  ASSERT_EQ(with_centres->pairs_3d3d.size(), 200U);
  EXPECT_NEAR(KabschRmse(with_centres->pairs_3d3d), 0.016, 1e-3);
}

TEST(AcfrPoses, FindsTheSixRelabelledPoses) {
  SEXTANT_REAL_DATA(path, "acfr_vlp16/poses.csv");
  const auto poses = ReadAcfrPoses(path);
  ASSERT_TRUE(poses);
  const auto relabelled = RelabelledAcfrPoses(*poses);
  ASSERT_TRUE(relabelled) << relabelled.error().message;
  EXPECT_THAT(*relabelled, testing::ElementsAre(7, 16, 17, 30, 31, 32));
}

TEST(AcfrPoses, NumbersTheCornersClockwiseFromTheTop) {
  SEXTANT_REAL_DATA(path, "acfr_vlp16/poses.csv");
  const auto problem = ProblemFromAcfrPoses(*ReadAcfrPoses(path));
  ASSERT_TRUE(problem);
  for (std::size_t i = 0; i < 160; i += 4) {
    const auto& p = problem->pairs_3d3d;
    EXPECT_LT(p[i].point_in_cam.y(), p[i + 2].point_in_cam.y());
    EXPECT_GT(p[i + 1].point_in_cam.x(), p[i + 3].point_in_cam.x());
    EXPECT_GT(p[i].point_in_lidar.z(), p[i + 2].point_in_lidar.z());
  }
}

TEST(AcfrPoses, RefusesBadText) {
  std::string good;
  for (int i = 0; i < 18; ++i) good += "1,2,3\n";
  good += "1,0,0\n";
  EXPECT_TRUE(ParseAcfrPoses(good, "p"));
  const BadText cases[] = {
      {"empty", "", ErrorCode::kParse, "p:1: the file ends here, expected x,y,z of the camera"},
      {"truncated", good + "1,2,3\n", ErrorCode::kParse, "p:20: the file ends here"},
      {"two", "1,2\n", ErrorCode::kParse, "expected x,y,z of the camera centre (mm), got 2 fields"},
      {"id", good.substr(0, good.size() - 6) + "x,0,0\n", ErrorCode::kParse, "p:19: field 1"},
      {"nan", "1,2,nan\n", ErrorCode::kNonFinite, "p:1: field 3"},
  };
  for (const BadText& bad : cases) ExpectRefused(ParseAcfrPoses(bad.text, "p"), bad);
}

}  // namespace
}  // namespace sextant
