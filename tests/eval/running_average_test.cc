// SPDX-License-Identifier: Apache-2.0
#include "eval/metrics/running_average.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "base/random.h"
#include "base/units.h"
#include "geometry/random_vectors.h"
#include "solvers/averaging/rotation_average.h"
#include "solvers/core/evaluation.h"
#include "solvers/kernels/kabsch.h"
#include "support/real_data.h"

namespace sextant {
namespace {

std::vector<Rigid3d> ScansAround(const Rigid3d& pose, int count, Random& random) {
  std::vector<Rigid3d> scans;
  for (int i = 0; i < count; ++i) {
    Vector6d delta;
    delta << 0.02 * NormalVector(random), 0.01 * NormalVector(random);
    scans.push_back(Perturb(pose, delta));
  }
  return scans;
}

double Printed(double value, double quantum) { return std::round(value / quantum) * quantum; }

// The log of the scans, repeated cyclically for `iterations` iterations, as the original package
// prints it.
std::vector<RunningAverageRow> Log(const std::vector<Rigid3d>& scans, int iterations) {
  std::vector<RunningAverageRow> rows;
  std::vector<Eigen::Quaterniond> rotations;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int k = 1; k <= iterations; ++k) {
    const Rigid3d& scan = scans[static_cast<std::size_t>(k - 1) % scans.size()];
    sum += scan.translation;
    rotations.push_back(scan.rotation);
    RunningAverageRow row;
    row.iteration = k;
    row.rotation = OriginalRunningAverage(rotations)->toRotationMatrix().unaryExpr(
        [](double x) { return Printed(x, 1e-8); });
    row.mean_translation_m = (sum / k).unaryExpr([](double x) {
      return Printed(x, std::pow(10.0, std::floor(std::log10(std::abs(x))) - 5.0));
    });
    rows.push_back(row);
  }
  return rows;
}

const Rigid3d kPose{ExpSo3({0.1, 0.4, -0.2}), {0.08, -0.12, -0.14}};

TEST(RunningAverage, RecoversScansAndPeriodOfALoop) {
  Random random(1);
  const std::vector<Rigid3d> scans = ScansAround(kPose, 7, random);
  const auto analysis = AnalyseRunningAverage(Log(scans, 40));
  ASSERT_TRUE(analysis) << analysis.error().message;
  EXPECT_EQ(analysis->distinct_scans, 7);
  EXPECT_EQ(analysis->period, 7);
  EXPECT_EQ(analysis->off_period, 0);
  std::vector<Eigen::Quaterniond> rotations;
  for (std::size_t i = 0; i < 40; ++i) {
    const RecoveredScan& scan = analysis->scans[i];
    const Rigid3d& truth = scans[i % 7];
    EXPECT_EQ(scan.repeats, static_cast<int>(i % 7) + 1);
    EXPECT_LT(RotationDistance(scan.cam_from_lidar.rotation, truth.rotation), 1e-7);
    const Eigen::Array3d error = (scan.cam_from_lidar.translation - truth.translation).array();
    EXPECT_TRUE((error.abs() <= scan.tolerance_m.array() + 1e-12).all());
    rotations.push_back(truth.rotation);
  }
  EXPECT_LT(RotationDistance(analysis->mean.rotation, *ChordalMean(rotations)), 1e-7);
  EXPECT_LT(RotationDistance(analysis->quaternion_sum, *QuaternionSumMean(rotations)), 1e-7);
}

// The sample standard deviation of n values is within five of its standard errors, 1 / sqrt(2 n -
// 2).
TEST(RunningAverage, MeasuresTheScatterOfDistinctScans) {
  Random random(2);
  const std::vector<Rigid3d> scans = ScansAround(kPose, 50, random);
  const auto once = AnalyseRunningAverage(Log(scans, 50));
  const auto thrice = AnalyseRunningAverage(Log(scans, 150));
  ASSERT_TRUE(once && thrice);
  EXPECT_FALSE(once->period);
  EXPECT_EQ(thrice->distinct_scans, 50);
  const double tolerance = 5.0 / std::sqrt(2.0 * 50.0 - 2.0);
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR((*once->standard_deviation)[i] / (i < 3 ? 0.02 : 0.01), 1.0, tolerance);
    EXPECT_NEAR((*thrice->standard_error)[i], (*once->standard_deviation)[i] / std::sqrt(50.0),
                1e-5);
  }
}

TEST(RunningAverage, ASingleScanHasNoStandardDeviation) {
  Random random(3);
  const auto analysis = AnalyseRunningAverage(Log({kPose}, 5));
  ASSERT_TRUE(analysis);
  EXPECT_EQ(analysis->distinct_scans, 1);
  EXPECT_EQ(analysis->period, 1);
  EXPECT_FALSE(analysis->standard_deviation);
  EXPECT_LT(analysis->logged_from_mean_rad, 1e-7);
}

TEST(RunningAverage, RejectsLogsThatCannotBeInverted) {
  Random random(4);
  const std::vector<RunningAverageRow> rows = Log(ScansAround(kPose, 5, random), 10);
  const auto error = [](const std::vector<RunningAverageRow>& log) {
    return AnalyseRunningAverage(log).error();
  };
  EXPECT_EQ(error({}).code, ErrorCode::kMissingData);
  EXPECT_EQ(error({rows.begin() + 1, rows.end()}).code, ErrorCode::kInvalidInput);
  std::vector<RunningAverageRow> gap = rows;
  gap.erase(gap.begin() + 4);
  EXPECT_NE(error(gap).message.find("row 5"), std::string::npos);
  std::vector<RunningAverageRow> skewed = rows;
  skewed[3].rotation(0, 0) += 0.01;
  EXPECT_EQ(error(skewed).code, ErrorCode::kInvalidInput);
  std::vector<RunningAverageRow> mirrored = rows;
  mirrored[3].rotation = -mirrored[3].rotation;
  EXPECT_EQ(error(mirrored).code, ErrorCode::kInvalidInput);
  std::vector<RunningAverageRow> nan = rows;
  nan[2].mean_translation_m.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(error(nan).code, ErrorCode::kNonFinite);
}

void Read(std::ifstream& file, Eigen::Vector3d& p) { file >> p.x() >> p.y() >> p.z(); }

std::vector<RunningAverageRow> ReadLog(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<RunningAverageRow> rows;
  for (RunningAverageRow row; file >> row.iteration;) {
    Read(file, row.mean_translation_m);
    for (int i = 0; i < 9; ++i) file >> row.rotation(i / 3, i % 3);
    file >> row.rmse_m;
    rows.push_back(row);
  }
  return rows;
}

std::vector<Pair3d3d> ReadPoints(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::size_t count = 0;
  file >> count;
  std::vector<Pair3d3d> pairs(count);
  for (Pair3d3d& pair : pairs) Read(file, pair.point_in_lidar);
  for (Pair3d3d& pair : pairs) Read(file, pair.point_in_cam);
  return pairs;
}

TEST(RunningAverage, AnalysesTheLogOfTheOriginal) {
  SEXTANT_REAL_DATA(path, "dhall");
  const auto analysis = AnalyseRunningAverage(ReadLog(path / "avg_values_head.txt"));
  ASSERT_TRUE(analysis) << analysis.error().message;
  EXPECT_EQ(analysis->scans.size(), 100U);
  // A recording of 18 scans in a loop. Scans 1 to 3 do not recur (19 to 21 replace them), and 42
  // differs from both 24 and 60 by thousands of times the rounding error: 18 + 3 + 1 distinct
  // scans.
  EXPECT_EQ(analysis->period, 18);
  EXPECT_EQ(analysis->off_period, 5);
  EXPECT_EQ(analysis->distinct_scans, 22);
  const Eigen::Vector3d mean_m(0.0812551, -0.126682, -0.141122);
  EXPECT_LT((analysis->mean.translation - mean_m).norm(), 1e-9);
  const Eigen::Quaterniond mean(0.9764957, -0.0178038, 0.2148005, -0.0000429);
  EXPECT_LT(RotationDistance(analysis->mean.rotation, mean.normalized()), 1e-6);
  EXPECT_NEAR(analysis->logged_from_mean_rad * kDegPerRad, 0.2796, 1e-4);

  CalibrationProblem problem;
  problem.pairs_3d3d = ReadPoints(path / "points_head.txt");
  const PointSets points = PointsOf(problem.pairs_3d3d);
  const Expected<KabschFit> tenth = FitKabsch(points.in_cam, points.in_lidar);
  ASSERT_TRUE(tenth);
  const PoseDistance distance = DistanceBetween(analysis->scans[9].cam_from_lidar, tenth->b_from_a);
  EXPECT_LT(distance.translation_m, 6e-6);
  EXPECT_LT(distance.rotation_rad, 1e-5);

  // The last scan repeats the tenth; its rotation is recovered from the logged average.
  EXPECT_EQ(analysis->scans[99].repeats, 10);
  const Rigid3d logged{analysis->logged_rotation, analysis->mean.translation};
  EXPECT_NEAR(*Evaluate(problem, logged).rmse_m, analysis->last_rmse_m, 1e-6);
  EXPECT_NEAR(analysis->last_rmse_m, 0.0407388, 1e-6);
}

}  // namespace
}  // namespace sextant
