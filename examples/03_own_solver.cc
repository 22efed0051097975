// SPDX-License-Identifier: Apache-2.0
// A solver of your own behind the registry: combinators wrap it like any other.
#include <Eigen/Geometry>
#include <cstdio>

#include "solvers/all/all_solvers.h"

// Least squares of the 3D distances with equal weights, by Eigen's own function.
class MySolver final : public sextant::Solver {
 public:
  explicit MySolver(const std::string& name) : Solver({.name = name, .needs = {.pairs_3d3d = 3}}) {}

 private:
  sextant::Expected<sextant::Estimate> DoSolve(
      const sextant::CalibrationProblem& problem) const override {
    const auto count = static_cast<Eigen::Index>(problem.pairs_3d3d.size());
    Eigen::Matrix3Xd in_lidar(3, count);
    Eigen::Matrix3Xd in_cam(3, count);
    sextant::Estimate estimate;
    for (int i = 0; i < count; ++i) {
      in_lidar.col(i) = problem.pairs_3d3d[static_cast<std::size_t>(i)].point_in_lidar;
      in_cam.col(i) = problem.pairs_3d3d[static_cast<std::size_t>(i)].point_in_cam;
      estimate.inliers.push_back(i);
    }
    const Eigen::Matrix4d pose = Eigen::umeyama(in_lidar, in_cam, false);
    estimate.cam_from_lidar.rotation = Eigen::Matrix3d(pose.topLeftCorner<3, 3>());
    estimate.cam_from_lidar.translation = pose.topRightCorner<3, 1>();
    return estimate;
  }
};

int main() {
  sextant::SolverRegistry registry = sextant::AllSolvers();
  sextant::SolverEntry entry;
  entry.name = entry.example = "my_solver";
  entry.summary = "least squares of the 3D distances, equal weights";
  entry.make = [](const sextant::SolverArguments& arguments) {
    return sextant::Expected<sextant::SolverPtr>(std::make_shared<MySolver>(arguments.name));
  };
  registry.Add(entry);

  sextant::CalibrationProblem problem;  // A shift by (0.1, 0.2, 0.3) m; every fifth pair is wrong.
  for (int i = 0; i < 20; ++i) {
    sextant::Pair3d3d& pair = problem.pairs_3d3d.emplace_back();
    pair.point_in_lidar = {2.0 + 0.1 * (i % 3), 0.2 * (i % 5), 0.15 * (i % 7)};
    pair.point_in_cam = pair.point_in_lidar + Eigen::Vector3d(0.1, i % 5 ? 0.2 : 0.9, 0.3);
  }
  for (const char* spec : {"my_solver", "ransac(my_solver)", "gnc(my_solver)", "gnc(kabsch)"}) {
    const auto solver = registry.Make(spec);
    if (!solver) return std::puts(solver.error().message.c_str()), 1;
    const auto report = (*solver)->Solve(problem);
    if (!report) return std::puts(report.error().message.c_str()), 1;
    const Eigen::Vector3d& t = report->cam_from_lidar.translation;
    std::printf("%-18s %8.4f %8.4f %8.4f m\n", spec, t.x(), t.y(), t.z());
  }
  return 0;
}
