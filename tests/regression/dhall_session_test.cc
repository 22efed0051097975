// SPDX-License-Identifier: Apache-2.0
// Pixels of a real session of ankitdhall/lidar_camera_calibration: the detected corners of its two
// tags, and the poses stored by its own pipeline.
#include <gtest/gtest.h>

#include <cmath>

#include "io/boards/marker_files.h"
#include "io/cameras/camera_file.h"
#include "io/original/original_config.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "support/real_data.h"

namespace sextant {
namespace {

constexpr double kMarkerSide = 0.205;

// A tag in its own frame, which takes the role of the LiDAR frame: x right, y up, corners clockwise
// from the top left.
CalibrationProblem ProblemOf(const DetectedMarker& marker, const Camera& camera) {
  constexpr double kHalf = 0.5 * kMarkerSide;
  const Eigen::Vector3d corners[] = {
      {-kHalf, kHalf, 0.0}, {kHalf, kHalf, 0.0}, {kHalf, -kHalf, 0.0}, {-kHalf, -kHalf, 0.0}};
  CalibrationProblem problem;
  problem.camera = camera;
  for (std::size_t i = 0; i < 4; ++i) {
    Pair2d3d pair;
    pair.pixel = marker.corners_px[i];
    pair.point_in_lidar = corners[i];
    pair.id = {.view = 0, .board = marker.id, .corner = static_cast<int>(i)};
    problem.pairs_2d3d.push_back(pair);
  }
  return problem;
}

SolveReport Solve(const char* spec, const CalibrationProblem& problem) {
  const Expected<SolverPtr> solver = BuiltinSolvers().Make(spec);
  EXPECT_TRUE(solver) << solver.error().message;
  const Expected<SolveReport> report = (*solver)->Solve(problem);
  EXPECT_TRUE(report) << spec << ": " << report.error().message;
  return report ? *report : SolveReport{};
}

TEST(DhallSession, LeastSquaresReproducesTheStoredPoses) {
  SEXTANT_REAL_DATA(ini, "dhall/zed_left_uurmi.ini");
  SEXTANT_REAL_DATA(transforms, "dhall/session_2017-05-03/transform.txt");
  const Expected<Camera> camera = ReadCamera(ini);
  const auto markers = ReadDetectedMarkers(transforms);
  ASSERT_TRUE(camera && markers);
  ASSERT_EQ(markers->size(), 2U);
  const double rmse_px[] = {0.198, 0.159};
  for (std::size_t i = 0; i < 2; ++i) {
    const DetectedMarker& marker = (*markers)[i];
    const CalibrationProblem problem = ProblemOf(marker, *camera);
    for (const char* spec : {"refine(ippe)", "refine(epnp)", "refine(sqpnp)"}) {
      const SolveReport report = Solve(spec, problem);
      const Eigen::Vector3d off = report.cam_from_lidar.translation - marker.translation_m;
      EXPECT_LT(off.cwiseAbs().maxCoeff(), 1e-5) << spec << ": " << off.transpose();
      EXPECT_NEAR(*report.evaluation.rmse_px, rmse_px[i], 5e-4) << spec;
      EXPECT_EQ(report.evaluation.per_pair_px.size(), 4U);
      EXPECT_EQ(report.inliers.size(), 4U);
      ASSERT_TRUE(report.covariance);
    }
    // Closed forms weight the pixels differently; the difference is below one sigma.
    const Matrix6d covariance = *Solve("refine(ippe)", problem).covariance;
    const double sigma_m = std::sqrt(covariance.bottomRightCorner<3, 3>().trace());
    for (const char* spec : {"ippe", "epnp"}) {
      const SolveReport report = Solve(spec, problem);
      EXPECT_LT((report.cam_from_lidar.translation - marker.translation_m).norm(), sigma_m) << spec;
      EXPECT_LT(*report.evaluation.rmse_px, 1.2 * rmse_px[i]) << spec;
    }
  }
}

// The camera matrix in the session's configuration belongs to another camera, which shows in the
// pose.
TEST(DhallSession, TheConfiguredMatrixGivesAWrongDistance) {
  SEXTANT_REAL_DATA(path, "dhall/session_2017-05-03/config_file.txt");
  SEXTANT_REAL_DATA(transforms, "dhall/session_2017-05-03/transform.txt");
  const Expected<OriginalConfig> config = ReadOriginalConfig(path);
  const auto markers = ReadDetectedMarkers(transforms);
  ASSERT_TRUE(config && markers);
  const Camera camera{.width_px = config->width_px,
                      .height_px = config->height_px,
                      .fx_px = config->projection(0, 0),
                      .fy_px = config->projection(1, 1),
                      .cx_px = config->projection(0, 2),
                      .cy_px = config->projection(1, 2)};
  const SolveReport report = Solve("refine(ippe)", ProblemOf(markers->front(), camera));
  EXPECT_NEAR(report.cam_from_lidar.translation.z(), 1.606, 1e-3);
  EXPECT_NEAR(markers->front().translation_m.z(), 1.782, 1e-3);
}

}  // namespace
}  // namespace sextant
