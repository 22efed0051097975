// SPDX-License-Identifier: Apache-2.0
#include "eval/metrics/compare.h"

namespace sextant {

std::vector<ComparisonRow> Compare(const CalibrationProblem& problem,
                                   std::span<const SolverPtr> solvers,
                                   const std::optional<Rigid3d>& true_cam_from_lidar,
                                   const ProgressCallback& progress) {
  std::vector<ComparisonRow> rows;
  std::optional<Rigid3d> first;
  ProgressCounter counter(progress, "solvers", solvers.size());
  for (const SolverPtr& solver : solvers) {
    ComparisonRow row{solver->spec().name, solver->Solve(problem), {}, {}};
    if (row.report) {
      const Rigid3d& pose = row.report->cam_from_lidar;
      if (!first) first = pose;
      row.from_first = DistanceBetween(pose, *first);
      if (true_cam_from_lidar) row.from_truth = DistanceBetween(pose, *true_cam_from_lidar);
    }
    rows.push_back(std::move(row));
    counter.Step();
  }
  counter.Finish();
  return rows;
}

}  // namespace sextant
