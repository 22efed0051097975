// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <numeric>

#include "geometry/pair_noise.h"
#include "geometry/residuals.h"
#include "solvers/core/registry.h"
#include "solvers/kernels/kabsch_fit.h"

namespace sextant {
namespace {

double WeightedSquares(std::span<const Pair3d3d> pairs, const Rigid3d& pose) {
  double sum = 0.0;
  for (const Pair3d3d& pair : pairs) {
    sum += IsotropicWeight(pair) * PointResidual(pose, pair).squaredNorm();
  }
  return sum;
}

std::optional<Matrix6d> CovarianceOf(std::span<const Pair3d3d> pairs, const KabschMoments& moments,
                                     const Rigid3d& pose) {
  if (std::any_of(pairs.begin(), pairs.end(),
                  [](const Pair3d3d& pair) { return pair.covariance_in_cam.has_value(); })) {
    return PropagateCovariance(pairs, IsotropicWeights(pairs), pose);
  }
  if (HasKnownNoise(pairs.front())) return KabschCovariance(moments, pose, 1.0);
  const double freedom = 3.0 * static_cast<double>(pairs.size()) - 6.0;
  return KabschCovariance(moments, pose, WeightedSquares(pairs, pose) / freedom);
}

// Shape: each buffer is at least as large as the sample.
std::optional<Rigid3d> FitSample(std::span<const Pair3d3d> pairs, std::span<const int> sample,
                                 std::span<Eigen::Vector3d> in_cam,
                                 std::span<Eigen::Vector3d> in_lidar, std::span<double> weights) {
  const std::size_t count = sample.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Pair3d3d& pair = pairs[static_cast<std::size_t>(sample[i])];
    in_cam[i] = pair.point_in_cam;
    in_lidar[i] = pair.point_in_lidar;
    weights[i] = IsotropicWeight(pair);
  }
  const KabschOutcome fit =
      FitPoints(in_cam.first(count), in_lidar.first(count), weights.first(count));
  if (!fit) return std::nullopt;
  return fit->b_from_a;
}

class KabschSolver final : public Solver {
 public:
  explicit KabschSolver(const std::string& name)
      : Solver({.name = name, .needs = {.pairs_3d3d = 3}}) {}

 private:
  Expected<Estimate> DoSolve(const CalibrationProblem& problem) const override {
    KabschMoments moments;
    const KabschOutcome fit = FitPairs(problem.pairs_3d3d, moments);
    if (!fit) {
      return tl::unexpected<Error>(ExplainKabsch(fit.error(), problem.pairs_3d3d.size()));
    }
    Estimate estimate;
    estimate.cam_from_lidar = fit->b_from_a;
    estimate.inliers.resize(problem.pairs_3d3d.size());
    std::iota(estimate.inliers.begin(), estimate.inliers.end(), 0);
    estimate.covariance = CovarianceOf(problem.pairs_3d3d, moments, fit->b_from_a);
    return estimate;
  }

  void DoHypothesize(const CalibrationProblem& problem, std::span<const int> sample,
                     std::vector<Rigid3d>& poses) const override {
    constexpr std::size_t kMaxOnStack = 64;
    std::optional<Rigid3d> pose;
    if (sample.size() <= kMaxOnStack) {
      std::array<Eigen::Vector3d, kMaxOnStack> in_cam;
      std::array<Eigen::Vector3d, kMaxOnStack> in_lidar;
      std::array<double, kMaxOnStack> weights;
      pose = FitSample(problem.pairs_3d3d, sample, in_cam, in_lidar, weights);
    } else {
      std::vector<Eigen::Vector3d> in_cam(sample.size());
      std::vector<Eigen::Vector3d> in_lidar(sample.size());
      std::vector<double> weights(sample.size());
      pose = FitSample(problem.pairs_3d3d, sample, in_cam, in_lidar, weights);
    }
    if (pose) poses.push_back(*pose);
  }
};

}  // namespace

SolverEntry KabschEntry() {
  return {
      .name = "kabsch",
      .summary = "least squares of the 3D distances in closed form, weighted by 1/sigma^2",
      .needs = "3 or more 3D-3D pairs, not on one line",
      .reference = "Kabsch 1976; Horn 1987 (quaternion form); eq. 12 to 18 of the paper",
      .example = "kabsch",
      .make = [](const SolverArguments& arguments) -> Expected<SolverPtr> {
        return std::make_shared<KabschSolver>(arguments.name);
      },
  };
}

}  // namespace sextant
