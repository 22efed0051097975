// SPDX-License-Identifier: Apache-2.0
// Our solvers compared with Eigen, opengv, PCL and Open3D on the same points: pairs with and
// without outliers, and points without correspondences. Pixel solvers of OpenCV and opengv are in
// bench_pnp and bench_refine.
#include <benchmark/benchmark.h>

#include <Eigen/Geometry>

#include "bench/peer_tasks.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "solvers/kernels/kabsch.h"

namespace sextant::bench {
namespace {

Prepare BySolver(const std::string& spec, bool paired) {
  const Expected<SolverPtr> solver = BuiltinSolvers().Make(spec);
  return [solver, paired](const PointProblem& points) -> PeerCall {
    CalibrationProblem problem;
    for (std::size_t i = 0; paired && i < points.in_cam.size(); ++i) {
      Pair3d3d pair;
      pair.point_in_cam = points.in_cam[i];
      pair.point_in_lidar = points.in_lidar[i];
      pair.sigma_m = points.sigma_m;
      problem.pairs_3d3d.push_back(pair);
    }
    if (!paired) {
      problem.point_sets = {.in_cam = points.in_cam, .in_lidar = points.in_lidar};
      problem.initial_cam_from_lidar = LocalStart();
    }
    return [solver, problem]() -> std::optional<Rigid3d> {
      if (!solver) return std::nullopt;
      const Expected<SolveReport> report = (*solver)->Solve(problem);
      if (!report) return std::nullopt;
      return report->cam_from_lidar;
    };
  };
}

}  // namespace

void RegisterOurs() {
  RegisterPairs("sextant", [](const PointProblem& points) -> PeerCall {
    return [&points]() -> std::optional<Rigid3d> {
      const Expected<KabschFit> fit = FitKabsch(points.in_cam, points.in_lidar);
      if (!fit) return std::nullopt;
      return fit->b_from_a;
    };
  });
  RegisterOutliers("sextant", BySolver("robust(kabsch)", true));
  RegisterOutliers("sextant_clique", BySolver("clique(kabsch)", true));
  RegisterOutliers("sextant_ransac", BySolver("ransac(kabsch)", true));
  RegisterOutliers("sextant_gnc", BySolver("gnc(kabsch)", true));
  RegisterCorners("sextant", BySolver("icp(init=identity)", false));
  RegisterRooms("sextant", BySolver("icp(match=projective,init=identity)", false));
}

void RegisterEigen() {
  RegisterPairs("eigen_umeyama", [](const PointProblem& points) -> PeerCall {
    const auto columns = [](const std::vector<Eigen::Vector3d>& from) -> Eigen::Matrix3Xd {
      return Eigen::Map<const Eigen::Matrix3Xd>(from[0].data(), 3,
                                                static_cast<Eigen::Index>(from.size()));
    };
    return [in_cam = columns(points.in_cam),
            in_lidar = columns(points.in_lidar)]() -> std::optional<Rigid3d> {
      const Eigen::Matrix4d matrix = Eigen::umeyama(in_lidar, in_cam, false);
      const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
      return Rigid3d{Eigen::Quaterniond(rotation), matrix.topRightCorner<3, 1>()};
    };
  });
}

}  // namespace sextant::bench

int main(int argc, char** argv) {
  sextant::bench::RegisterOurs();
  sextant::bench::RegisterEigen();
#ifdef SEXTANT_BENCH_OPENGV
  sextant::bench::RegisterOpengv();
#endif
#ifdef SEXTANT_BENCH_PCL
  sextant::bench::RegisterPcl();
#endif
#ifdef SEXTANT_BENCH_OPEN3D
  sextant::bench::RegisterOpen3d();
#endif
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
