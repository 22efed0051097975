// SPDX-License-Identifier: Apache-2.0
#include <numeric>

#include "geometry/pair_noise.h"
#include "geometry/residuals.h"
#include "solvers/core/registry.h"

namespace sextant {
namespace {

/// The mu_offset column of the paper's tables 3 to 5: the weighted mean of
/// point_in_cam - R point_in_lidar with a given R (that of the initial pose, else the identity).
///
/// The covariance is conditional on that R: its rotation block is zero.
class MeanOffsetSolver final : public Solver {
 public:
  explicit MeanOffsetSolver(const std::string& name)
      : Solver({.name = name, .needs = {.pairs_3d3d = 1}, .estimates_rotation = false}) {}

 private:
  Expected<Estimate> DoSolve(const CalibrationProblem& problem) const override {
    const std::vector<Pair3d3d>& pairs = problem.pairs_3d3d;
    const std::vector<double> weights = IsotropicWeights(pairs);
    Rigid3d pose;
    if (problem.initial_cam_from_lidar) pose.rotation = problem.initial_cam_from_lidar->rotation;
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < pairs.size(); ++i)
      sum += weights[i] * PointResidual(pose, pairs[i]);
    pose.translation = sum / total;

    Estimate estimate;
    estimate.cam_from_lidar = pose;
    estimate.inliers.resize(pairs.size());
    std::iota(estimate.inliers.begin(), estimate.inliers.end(), 0);
    estimate.covariance = Covariance(pairs, weights, total, pose);
    return estimate;
  }

  static std::optional<Matrix6d> Covariance(std::span<const Pair3d3d> pairs,
                                            std::span<const double> weights, double total,
                                            const Rigid3d& pose) {
    Eigen::Matrix3d noise = Eigen::Matrix3d::Zero();
    if (HasKnownNoise(pairs.front())) {
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        noise += weights[i] * weights[i] * StatedCovariance(pairs[i]);
      }
      noise /= total * total;
    } else {
      if (pairs.size() < 2) return std::nullopt;
      double squares = 0.0;
      for (const Pair3d3d& pair : pairs) squares += PointResidual(pose, pair).squaredNorm();
      const double n = static_cast<double>(pairs.size());
      noise = Eigen::Matrix3d::Identity() * (squares / (3.0 * n - 3.0) / n);
    }
    Matrix6d covariance = Matrix6d::Zero();
    covariance.bottomRightCorner<3, 3>() = noise;
    return covariance;
  }
};

}  // namespace

SolverEntry MeanOffsetEntry() {
  return {
      .name = "mean_offset",
      .summary = "translation only: mean of the differences, with the initial rotation (or none)",
      .needs = "1 or more 3D-3D pairs",
      .reference = "mu_offset in tables 3 to 5 of the paper",
      .example = "mean_offset",
      .make = [](const SolverArguments& arguments) -> Expected<SolverPtr> {
        return std::make_shared<MeanOffsetSolver>(arguments.name);
      },
  };
}

}  // namespace sextant
