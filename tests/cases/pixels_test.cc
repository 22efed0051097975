// SPDX-License-Identifier: Apache-2.0
// Pixels from the field: what every solver answers, or refuses, where the data is difficult.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "io/cameras/camera_file.h"
#include "io/problems/pairs_csv.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "support/real_data.h"

namespace sextant {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

CalibrationProblem PixelsOf(const std::filesystem::path& pairs, const char* camera) {
  CalibrationProblem problem = ReadPairsCsv(pairs).value();
  problem.camera = ReadCamera(pairs.parent_path() / camera).value();
  return problem;
}

Expected<SolveReport> AnswerOf(const CalibrationProblem& problem, const std::string& spec) {
  return BuiltinSolvers().Make(spec).value()->Solve(problem);
}

double DistanceTo(const Eigen::Vector3d& right, const SolveReport& report) {
  return (report.cam_from_lidar.translation - right).norm();
}

TEST(FieldPixels, ATriangleThatNoiseDeprivesOfItsPoseIsNotTheAnswer) {
  SEXTANT_REAL_DATA(tilt40, "../cases/ippe_alternative/tilt40.csv");
  for (const char* file : {"tilt20.csv", "tilt40.csv", "tilt55.csv"}) {
    const CalibrationProblem problem = PixelsOf(tilt40.parent_path() / file, "camera.yaml");
    for (const char* spec : {"p3p", "ippe", "sqpnp", "epnp", "refine(p3p)"}) {
      const Expected<SolveReport> report = AnswerOf(problem, spec);
      ASSERT_TRUE(report) << file << ", " << spec << ": " << report.error().message;
      EXPECT_LT(report->evaluation.rmse_px.value(), 0.5) << file << ", " << spec;
      EXPECT_LT(DistanceTo({0.05, -0.12, -0.08}, *report), 0.02) << file << ", " << spec;
      EXPECT_THAT(report->alternatives, IsEmpty()) << file << ", " << spec;
    }
  }
}

TEST(FieldPixels, FourPairsThatAgreeExactlyDoNotOutweighEight) {
  SEXTANT_REAL_DATA(pairs, "../cases/two_markers_two_poses/pairs.csv");
  const CalibrationProblem problem = PixelsOf(pairs, "camera.yaml");
  for (const char* spec : {"refine(sqpnp)", "refine(p3p)", "ransac(p3p)", "refine(ransac(p3p))"}) {
    const Expected<SolveReport> report = AnswerOf(problem, spec);
    ASSERT_TRUE(report) << spec << ": " << report.error().message;
    EXPECT_THAT(report->inliers, SizeIs(8)) << spec;
    EXPECT_LT(DistanceTo({-0.850, 0.017, 0.283}, *report), 2e-3) << spec;
    ASSERT_THAT(report->alternatives, SizeIs(1)) << spec;
    const Eigen::Vector3d other = report->alternatives[0].translation;
    EXPECT_LT((other - Eigen::Vector3d(0.657, -0.009, 0.592)).norm(), 2e-3) << spec;
  }
}

TEST(FieldPixels, AFisheyeBeyondTheImagePlane) {
  SEXTANT_REAL_DATA(to88, "../cases/fisheye_beyond_90/pairs_to88.csv");
  struct Case {
    const char* file;
    Eigen::Vector3d right;
  };
  for (const Case& of : {Case{"pairs_to88.csv", {0.0509, -0.1220, -0.0790}},
                         Case{"pairs_beyond90.csv", {0.0514, -0.1218, -0.0784}}}) {
    const CalibrationProblem problem = PixelsOf(to88.parent_path() / of.file, "camera.yaml");
    for (const char* spec : {"sqpnp", "epnp", "dlt", "refine(sqpnp)", "refine(p3p)", "gnc(epnp)",
                             "ransac(p3p)", "drop_worst(sqpnp)"}) {
      const Expected<SolveReport> report = AnswerOf(problem, spec);
      ASSERT_TRUE(report) << of.file << ", " << spec << ": " << report.error().message;
      EXPECT_LT(DistanceTo(of.right, *report), 1.5e-3) << of.file << ", " << spec;
      ASSERT_TRUE(report->covariance) << of.file << ", " << spec;
    }
    EXPECT_THAT(AnswerOf(problem, "sqpnp")->warnings, testing::Contains(HasSubstr("168 deg")));
    const Expected<SolveReport> ippe = AnswerOf(problem, "ippe");
    ASSERT_FALSE(ippe);
    EXPECT_THAT(ippe.error().message, HasSubstr("use p3p"));
  }
}

TEST(FieldPixels, ThreePairsHaveTwoExactPoses) {
  SEXTANT_REAL_DATA(pairs, "../cases/csv_dialects/three.csv");
  const CalibrationProblem problem = PixelsOf(pairs, "../wrong_data/plain.yaml");
  for (const char* spec : {"p3p", "refine(p3p)", "refine(sqpnp)"}) {
    const Expected<SolveReport> report = AnswerOf(problem, spec);
    ASSERT_TRUE(report) << spec << ": " << report.error().message;
    EXPECT_THAT(report->alternatives, SizeIs(1)) << spec;
    EXPECT_FALSE(report->covariance) << spec;
  }
}

}  // namespace
}  // namespace sextant
