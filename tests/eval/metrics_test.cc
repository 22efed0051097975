// SPDX-License-Identifier: Apache-2.0
#include "eval/metrics/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "base/random.h"
#include "base/units.h"

namespace sextant {
namespace {

std::vector<double> Measure(const KnownProblem& known, const Expected<SolveReport>& report) {
  std::vector<double> values(PoseMetrics().size(), std::nan(""));
  MeasurePose(known, report, {}, {std::bitset<kMaxMetrics>().set(), values});
  return values;
}

// Two points one metre apart along x; the estimate is rotated by one degree about z and shifted.
KnownProblem TwoPoints() {
  KnownProblem known;
  known.problem.camera = Camera{.width_px = 1280,
                                .height_px = 720,
                                .fx_px = 700.0,
                                .fy_px = 700.0,
                                .cx_px = 639.5,
                                .cy_px = 359.5};
  for (const double x : {-0.5, 0.5}) {
    const Eigen::Vector3d point(x, 0.0, 2.0);
    known.problem.pairs_3d3d.push_back(
        {.point_in_cam = point, .point_in_lidar = point, .covariance_in_cam = {}, .id = {}});
    known.problem.pairs_2d3d.push_back(
        {.pixel = *Project(*known.problem.camera, point), .point_in_lidar = point, .id = {}});
  }
  known.held_out = known.problem;
  return known;
}

TEST(PoseMetrics, HaveDistinctNamesInTheOrderOfTheirIndices) {
  ASSERT_EQ(PoseMetrics().size(), static_cast<std::size_t>(kPoseMetricCount));
  std::set<std::string> names;
  for (const Metric& metric : PoseMetrics()) names.insert(metric.name);
  EXPECT_EQ(names.size(), PoseMetrics().size());
  EXPECT_EQ(PoseMetrics()[kRotationDeg].name, "rotation_deg");
  EXPECT_EQ(PoseMetrics()[kNees].name, "nees");
  EXPECT_EQ(PoseMetrics()[kHeldOutPx].name, "held_out_px");
  EXPECT_EQ(PoseMetrics()[kTimeUs].name, "time_us");
}

TEST(MeasurePose, MeasuresEachErrorByItsDefinition) {
  const KnownProblem known = TwoPoints();
  SolveReport report;
  report.cam_from_lidar = {ExpSo3({0.0, 0.0, kRadPerDeg}), {0.003, 0.0, -0.004}};
  report.evaluation = Evaluate(known.problem, report.cam_from_lidar);
  report.inliers = {0, 1};
  report.covariance = Matrix6d(Matrix6d::Identity() * 1e-4);
  const std::vector<double> values = Measure(known, report);
  EXPECT_EQ(values[kAnswered], 1.0);
  EXPECT_EQ(values[kFine], 1.0);
  EXPECT_EQ(values[kSuccess], 0.0) << "a degree is no success";
  EXPECT_NEAR(values[kRotationDeg], 1.0, 1e-12);
  EXPECT_NEAR(values[kTranslationMm], 5.0, 1e-12);
  EXPECT_NEAR(values[kXMm], 3.0, 1e-12);
  EXPECT_NEAR(values[kZMm], -4.0, 1e-12);
  EXPECT_NEAR(values[kNees], (kRadPerDeg * kRadPerDeg + 25e-6) / 1e-4, 1e-9);
  EXPECT_NEAR(values[kEstimatedYawDeg], 1.0, 1e-12);
  // Each point is displaced by the rotation of one degree at half a metre, and by the shift.
  const double chord = 2.0 * 0.5 * std::sin(0.5 * kRadPerDeg);
  EXPECT_NEAR(values[kRmseMm] * values[kRmseMm], 1e6 * (chord * chord + 25e-6), 1e-3);
  EXPECT_EQ(values[kHeldOutMm], values[kRmseMm]);
  EXPECT_EQ(values[kHeldOutPx], values[kRmsePx]);
  EXPECT_LE(values[kMeanPx], values[kRmsePx]);
  EXPECT_EQ(values[kInliers], 2.0);
}

TEST(MeasurePose, AnErrorHasNoValues) {
  const std::vector<double> values =
      Measure(TwoPoints(), MakeError(ErrorCode::kDegenerate, "on a line"));
  EXPECT_EQ(values[kAnswered], 0.0);
  EXPECT_EQ(values[kFine], 0.0);
  EXPECT_EQ(values[kSuccess], 0.0);
  EXPECT_TRUE(std::isnan(values[kRotationDeg]));
  EXPECT_TRUE(std::isnan(values[kRmseMm]));
}

// The paper's dataset 2 prints an RMSE of ICP below that of Kabsch. No pose can have a smaller RMSE
// on the pairs than the optimum, but the distance to nearest neighbours is never larger than that
// to the paired points.
TEST(NearestNeighbourRmse, IsNeverLargerThanTheRmseOfThePairs) {
  Random random(5);
  for (int trial = 0; trial < 50; ++trial) {
    PointSets sets;
    double sum = 0.0;
    const Rigid3d pose = {ExpSo3({0.0, 0.0, random.Uniform(0.0, 3.0)}), {0.1, 0.0, 0.0}};
    for (int i = 0; i < 12; ++i) {
      Eigen::Vector3d a;
      Eigen::Vector3d b;
      for (int axis = 0; axis < 3; ++axis) a[axis] = random.Normal();
      for (int axis = 0; axis < 3; ++axis) b[axis] = random.Normal();
      sets.in_cam.push_back(a);
      sets.in_lidar.push_back(b);
      sum += (a - pose * b).squaredNorm();
    }
    EXPECT_LE(NearestNeighbourRmse(sets, pose), std::sqrt(sum / 12.0));
  }
}

TEST(Nees, IsNanForASingularCovariance) { EXPECT_TRUE(std::isnan(Nees({}, Matrix6d::Zero(), {}))); }

}  // namespace
}  // namespace sextant
