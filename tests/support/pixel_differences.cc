// SPDX-License-Identifier: Apache-2.0
#include "support/pixel_differences.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>

namespace sextant::test {
namespace {

constexpr double kMaxBend = 0.1;

Rigid3d PoseNear(const Solver& solver, const CalibrationProblem& problem, const Rigid3d& near) {
  std::vector<int> all(problem.pairs_2d3d.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<Rigid3d> poses;
  solver.Hypothesize(problem, all, poses);
  EXPECT_FALSE(poses.empty());
  if (poses.empty()) return near;
  const auto distance = [&](const Rigid3d& pose) {
    return PoseDifference(pose, near).squaredNorm();
  };
  return *std::min_element(poses.begin(), poses.end(), [&](const Rigid3d& a, const Rigid3d& b) {
    return distance(a) < distance(b);
  });
}

}  // namespace

std::optional<Matrix6d> CovarianceByPixelDifferences(const Solver& solver,
                                                     const CalibrationProblem& problem,
                                                     const Rigid3d& cam_from_lidar) {
  const double step_px = 1e-5 * problem.camera->fx_px;
  CalibrationProblem displaced = problem;
  Matrix6d covariance = Matrix6d::Zero();
  for (std::size_t i = 0; i < problem.pairs_2d3d.size(); ++i) {
    const Pair2d3d& pair = problem.pairs_2d3d[i];
    for (int axis = 0; axis < 2; ++axis) {
      double& coordinate = displaced.pairs_2d3d[i].pixel[axis];
      coordinate = pair.pixel[axis] + step_px;
      const Rigid3d ahead = PoseNear(solver, displaced, cam_from_lidar);
      coordinate = pair.pixel[axis] - step_px;
      const Rigid3d behind = PoseNear(solver, displaced, cam_from_lidar);
      coordinate = pair.pixel[axis];
      const Vector6d slope = PoseDifference(ahead, behind) / (2.0 * step_px);
      // The two one-sided differences of a smooth function differ only in second order.
      const Vector6d bend = PoseDifference(ahead, cam_from_lidar) / step_px - slope;
      if (bend.norm() > kMaxBend * slope.norm()) return std::nullopt;
      covariance += pair.sigma_px * pair.sigma_px * slope * slope.transpose();
    }
  }
  return covariance;
}

double WhitenedDifference(const Matrix6d& a, const Matrix6d& b) {
  const Eigen::LLT<Matrix6d> factor(b);
  const Matrix6d half = factor.matrixL().solve(a - b);
  const Matrix6d whitened = factor.matrixL().solve(half.transpose());
  return whitened.cwiseAbs().maxCoeff();
}

}  // namespace sextant::test
