// SPDX-License-Identifier: Apache-2.0
// Points that both sensors measured -> cam_from_lidar with its uncertainty.
#include <cstdio>

#include "base/units.h"
#include "solvers/all/all_solvers.h"

// The corners of two boards [m]: x y z in the LiDAR frame, then in the camera frame.
constexpr double kCorners[][6] = {
    {1.901, 0.506, 0.341, -0.501, -0.428, 1.821}, {1.997, 0.172, 0.001, -0.178, -0.091, 1.934},
    {1.912, 0.503, -0.347, -0.511, 0.250, 1.827}, {1.806, 0.823, -0.012, -0.827, -0.099, 1.712},
    {2.400, -0.542, 0.439, 0.527, -0.511, 2.353}, {2.280, -0.873, 0.111, 0.850, -0.176, 2.258},
    {2.389, -0.566, -0.239, 0.540, 0.165, 2.359}, {2.520, -0.231, 0.087, 0.203, -0.168, 2.464}};

int main() {
  sextant::CalibrationProblem problem;
  for (const auto& c : kCorners) {
    sextant::Pair3d3d& pair = problem.pairs_3d3d.emplace_back();
    pair.point_in_lidar = {c[0], c[1], c[2]};
    pair.point_in_cam = {c[3], c[4], c[5]};
    pair.sigma_m = 0.007;  // Per axis of their difference; 0 for all pairs: estimated from them.
  }
  const auto solver = sextant::AllSolvers().Make("gnc(kabsch)");
  if (!solver) return std::puts(solver.error().message.c_str()), 1;
  const auto report = (*solver)->Solve(problem);
  if (!report) return std::puts(report.error().message.c_str()), 1;

  const Eigen::Matrix3d rotation = report->cam_from_lidar.rotation.toRotationMatrix();
  const Eigen::Vector3d& translation = report->cam_from_lidar.translation;
  std::puts("cam_from_lidar");
  for (int i = 0; i < 3; ++i) {
    std::printf("%12.6f %12.6f %12.6f %12.6f\n", rotation(i, 0), rotation(i, 1), rotation(i, 2),
                translation(i));
  }
  if (!report->covariance) return 0;
  const sextant::Vector6d sigma = report->covariance->diagonal().cwiseSqrt();
  std::printf("1 sigma about x y z: %.3f %.3f %.3f deg\n", sigma[0] * sextant::kDegPerRad,
              sigma[1] * sextant::kDegPerRad, sigma[2] * sextant::kDegPerRad);
  std::printf("1 sigma along x y z: %.1f %.1f %.1f mm\n", sigma[3] * 1e3, sigma[4] * 1e3,
              sigma[5] * 1e3);
  return 0;
}
