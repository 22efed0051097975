// SPDX-License-Identifier: Apache-2.0
#include "solvers/core/evaluation.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "geometry/residuals.h"
#include "solvers/kernels/pair_simd.h"
#include "solvers/kernels/pixel_sums.h"

namespace sextant {
namespace {

struct PairSums {
  double squares = 0.0;   // Of the residuals [m^2].
  double whitened = 0.0;  // Of the residuals over their sigma, where it is a number.
};

template <class Real>
SEXTANT_INLINE Real SquaredResidual(const RotationMatrix<double>& r, const Point3<double>& t,
                                    const Point3<Real>& in_lidar, const Point3<Real>& in_cam) {
  const Real x = in_cam.x - (r.xx * in_lidar.x + r.xy * in_lidar.y + r.xz * in_lidar.z + t.x);
  const Real y = in_cam.y - (r.yx * in_lidar.x + r.yy * in_lidar.y + r.yz * in_lidar.z + t.y);
  const Real z = in_cam.z - (r.zx * in_lidar.x + r.zy * in_lidar.y + r.zz * in_lidar.z + t.z);
  return x * x + y * y + z * z;
}

SEXTANT_INLINE double InverseVariance(const Pair3d3d& pair) {
  return pair.sigma_m > 0.0 ? 1.0 / (pair.sigma_m * pair.sigma_m) : 1.0;
}

// Eight pairs at a time, then one. Shape: as many distances as pairs.
SEXTANT_MULTIVERSION PairSums SumResiduals(std::span<const Pair3d3d> pairs,
                                           const RotationMatrix<double>& r, const Point3<double>& t,
                                           double* distances) {
  Vec8d squares{};
  Vec8d whitened{};
  std::size_t i = 0;
  for (; i + kSimdWidth <= pairs.size(); i += kSimdWidth) {
    const Pair3d3d* p = &pairs[i];
    const Vec8d squared = SquaredResidual(r, t, Gather<Vec8d>(p, &Pair3d3d::point_in_lidar),
                                          Gather<Vec8d>(p, &Pair3d3d::point_in_cam));
    StoreVec(Sqrt(squared), distances + i);
    const Vec8d sigma = {p[0].sigma_m, p[1].sigma_m, p[2].sigma_m, p[3].sigma_m,
                         p[4].sigma_m, p[5].sigma_m, p[6].sigma_m, p[7].sigma_m};
    squares += squared;
    whitened += sigma > 0.0 ? squared / (sigma * sigma) : squared;
  }
  PairSums sums = {HorizontalSum(squares), HorizontalSum(whitened)};
  for (; i < pairs.size(); ++i) {
    const double squared =
        SquaredResidual(r, t, PointAt(pairs[i].point_in_lidar), PointAt(pairs[i].point_in_cam));
    distances[i] = std::sqrt(squared);
    sums.squares += squared;
    sums.whitened += squared * InverseVariance(pairs[i]);
  }
  return sums;
}

void EvaluatePairs3d3d(const CalibrationProblem& problem, const Rigid3d& cam_from_lidar,
                       Evaluation& evaluation) {
  const std::span<const Pair3d3d> pairs = problem.pairs_3d3d;
  if (pairs.empty()) return;
  const Eigen::Quaterniond& q = cam_from_lidar.rotation;
  evaluation.per_pair_m.resize(pairs.size());
  const PairSums sums =
      SumResiduals(pairs, MakeRotationMatrix(Vector4<double>{q.x(), q.y(), q.z(), q.w()}),
                   PointAt(cam_from_lidar.translation), evaluation.per_pair_m.data());
  evaluation.cost += 0.5 * sums.whitened;
  for (const Pair3d3d& pair : pairs) {
    if (!pair.covariance_in_cam) continue;
    const Eigen::Vector3d residual = PointResidual(cam_from_lidar, pair);
    evaluation.cost += 0.5 * (residual.dot(pair.covariance_in_cam->llt().solve(residual)) -
                              residual.squaredNorm() * InverseVariance(pair));
  }
  evaluation.rmse_m = std::sqrt(sums.squares / static_cast<double>(pairs.size()));
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
