// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"

// Solves a translation that is known; 0 where the answer is right.
int main() {
  const sextant::Expected<sextant::SolverPtr> solver = sextant::BuiltinSolvers().Make("kabsch");
  if (!solver) {
    std::puts(solver.error().message.c_str());
    return 1;
  }

  const Eigen::Vector3d shift(1.0, -2.0, 3.0);
  sextant::CalibrationProblem problem;
  for (const Eigen::Vector3d& point : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0),
                                       Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1)}) {
    problem.pairs_3d3d.push_back({.point_in_cam = point + shift, .point_in_lidar = point});
  }
  const sextant::Expected<sextant::SolveReport> report = (*solver)->Solve(problem);
  if (!report) {
    std::puts(report.error().message.c_str());
    return 1;
  }
  return (report->cam_from_lidar.translation - shift).norm() < 1e-12 ? 0 : 1;
}
