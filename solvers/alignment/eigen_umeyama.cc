// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <numeric>

#include "geometry/pair_noise.h"
#include "solvers/core/registry.h"
#include "solvers/kernels/kabsch.h"

namespace sextant {
namespace {

/// Eigen's closed form, for comparison with kabsch. It gives all pairs equal weights and does not
/// detect degenerate or mirrored sets, which FitKabsch rejects first.
class EigenUmeyamaSolver final : public Solver {
 public:
  explicit EigenUmeyamaSolver(const std::string& name)
      : Solver({.name = name, .needs = {.pairs_3d3d = 3}}) {}

 private:
  Expected<Estimate> DoSolve(const CalibrationProblem& problem) const override {
    const std::vector<Pair3d3d>& pairs = problem.pairs_3d3d;
    const auto count = static_cast<Eigen::Index>(pairs.size());
    Eigen::Matrix3Xd in_lidar(3, count);
    Eigen::Matrix3Xd in_cam(3, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      in_lidar.col(i) = pairs[static_cast<std::size_t>(i)].point_in_lidar;
      in_cam.col(i) = pairs[static_cast<std::size_t>(i)].point_in_cam;
    }
    const PointSets points = PointsOf(pairs);
    if (const auto fit = FitKabsch(points.in_cam, points.in_lidar); !fit) {
      return tl::unexpected<Error>(fit.error());
    }
    const Eigen::Matrix4d matrix = Eigen::umeyama(in_lidar, in_cam, /*with_scaling=*/false);
    Estimate estimate;
    estimate.cam_from_lidar.rotation =
        Eigen::Quaterniond(Eigen::Matrix3d(matrix.topLeftCorner<3, 3>())).normalized();
    estimate.cam_from_lidar.translation = matrix.topRightCorner<3, 1>();
    estimate.inliers.resize(pairs.size());
    std::iota(estimate.inliers.begin(), estimate.inliers.end(), 0);
    const std::vector<double> equal_weights(pairs.size(), 1.0);
    estimate.covariance = PropagateCovariance(pairs, equal_weights, estimate.cam_from_lidar);
    return estimate;
  }
};

}  // namespace

SolverEntry EigenUmeyamaEntry() {
  return {
      .name = "eigen.umeyama",
      .summary = "Eigen's closed form of the same least squares, with equal weights",
      .needs = "3 or more 3D-3D pairs, not on one line",
      .reference = "Umeyama 1991; Eigen::umeyama",
      .example = "eigen.umeyama",
      .make = [](const SolverArguments& arguments) -> Expected<SolverPtr> {
        return std::make_shared<EigenUmeyamaSolver>(arguments.name);
      },
  };
}

}  // namespace sextant
