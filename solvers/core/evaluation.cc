// SPDX-License-Identifier: Apache-2.0
#include "solvers/core/evaluation.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "geometry/residuals.h"
#include "solvers/kernels/pair_errors.h"
#include "solvers/kernels/pixel_sums.h"

namespace sextant {
namespace {

double InverseVariance(const Pair3d3d& pair) {
  return pair.sigma_m > 0.0 ? 1.0 / (pair.sigma_m * pair.sigma_m) : 1.0;
}

void EvaluatePairs3d3d(const CalibrationProblem& problem, const Rigid3d& cam_from_lidar,
                       Evaluation& evaluation) {
  const std::span<const Pair3d3d> pairs = problem.pairs_3d3d;
  if (pairs.empty()) return;
  evaluation.per_pair_m.resize(pairs.size());
  const PairErrors errors = MeasurePairs(pairs, cam_from_lidar, evaluation.per_pair_m);
  evaluation.cost += 0.5 * errors.squares;
  for (const Pair3d3d& pair : pairs) {
    if (!pair.covariance_in_cam) continue;
    const Eigen::Vector3d residual = PointResidual(cam_from_lidar, pair);
    evaluation.cost += 0.5 * (residual.dot(pair.covariance_in_cam->llt().solve(residual)) -
                              residual.squaredNorm() * InverseVariance(pair));
  }
  evaluation.rmse_m = std::sqrt(errors.squares_m2 / static_cast<double>(pairs.size()));
}

void EvaluatePairs2d3d(const CalibrationProblem& problem, const Rigid3d& cam_from_lidar,
                       Evaluation& evaluation) {
  if (!problem.camera) return;
  if (problem.camera->model == CameraModel::kPinhole) {
    evaluation.per_pair_px.resize(problem.pairs_2d3d.size());
    const PixelErrors errors = MeasurePixels(
        problem.pairs_2d3d, PinholePose(*problem.camera, cam_from_lidar), evaluation.per_pair_px);
    evaluation.cost += 0.5 * errors.squares;
    if (errors.projected > 0) evaluation.rmse_px = std::sqrt(errors.squares_px2 / errors.projected);
    return;
  }
  evaluation.per_pair_px.reserve(problem.pairs_2d3d.size());
  double sum = 0.0;
  int projected = 0;
  for (const Pair2d3d& pair : problem.pairs_2d3d) {
    const auto residual = ReprojectionResidual(*problem.camera, cam_from_lidar, pair);
    if (!residual) {
      evaluation.per_pair_px.push_back(std::numeric_limits<double>::infinity());
      continue;
    }
    const double sigma = pair.sigma_px > 0.0 ? pair.sigma_px : 1.0;
    evaluation.per_pair_px.push_back(residual->norm());
    evaluation.cost += 0.5 * residual->squaredNorm() / (sigma * sigma);
    sum += residual->squaredNorm();
    ++projected;
  }
  if (projected > 0) evaluation.rmse_px = std::sqrt(sum / projected);
}

}  // namespace

Evaluation Evaluate(const CalibrationProblem& problem, const Rigid3d& cam_from_lidar) {
  Evaluation evaluation;
  EvaluatePairs3d3d(problem, cam_from_lidar, evaluation);
  EvaluatePairs2d3d(problem, cam_from_lidar, evaluation);
  return evaluation;
}

}  // namespace sextant
