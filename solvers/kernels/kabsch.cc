// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/kabsch.h"

#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>

#include "solvers/kernels/kabsch_fit.h"
#include "solvers/kernels/kabsch_kernel.h"
#include "solvers/kernels/trace_formula.h"

namespace sextant {
namespace {

// A factor of five in RMSE: noise on four coplanar points reaches it less than once in a thousand.
constexpr double kMirrorRatio = 25.0;

// False where the residual does not prove the result of the formula.
SEXTANT_INLINE bool FitMoments(const CentredMoments<double>& m, KernelFit& fit) {
  const std::optional<TraceMaximum> best = MaximizeTraceByFormula(m.cross, 0.5 * m.squares);
  if (!best) return false;
  fit = {best->q, m.mean_b - Rotate(best->matrix, m.mean_a), best->trace, best->mirrored_trace};
  return true;
}

template <class V>
SEXTANT_INLINE bool FitByFormulaFor(const PointSpans& points, CentredMoments<double>& moments,
                                    KernelFit& fit) {
  const CentredMoments<double> m = points.weights.empty() ? ComputeMoments<V, false, false>(points)
                                                          : ComputeMoments<V, true, false>(points);
  moments.squares = m.squares;
  if (FitMoments(m, fit)) return true;
  moments = m;
  return false;
}

template <class V>
SEXTANT_INLINE bool FitByFormulaFor(const WeightedPoints& pairs, CentredMoments<double>& moments,
                                    KernelFit& fit) {
  moments = ComputeMoments<V, true, true>(pairs);
  return FitMoments(moments, fit);
}

SEXTANT_SIMD_DISPATCH(bool, FitByFormula,
                      (const PointSpans& points, CentredMoments<double>& moments, KernelFit& fit),
                      (points, moments, fit))
SEXTANT_SIMD_DISPATCH(bool, FitByFormula,
                      (const WeightedPoints& pairs, CentredMoments<double>& moments,
                       KernelFit& fit),
                      (pairs, moments, fit))

template <class Points>
KabschOutcome Fit(const Points& points, CentredMoments<double>& moments) {
  if (points.size() < 3) return tl::unexpected(ErrorCode::kTooFewPairs);
  KernelFit kernel;
  if (!FitByFormula(points, moments, kernel) && !FitByEigensolver(moments, kernel)) {
    return tl::unexpected(ErrorCode::kDegenerate);
  }
  return CheckFit(kernel, moments.squares);
}

Eigen::Matrix3d Dense(const SymmetricMatrix<double>& s) {
  Eigen::Matrix3d dense;
  dense << s.xx, s.xy, s.xz, s.xy, s.yy, s.yz, s.xz, s.yz, s.zz;
  return dense;
}

Eigen::Matrix3d TraceLess(const Eigen::Matrix3d& m) {
  return m.trace() * Eigen::Matrix3d::Identity() - m;
}

}  // namespace

bool FitByEigensolver(const CentredMoments<double>& m, KernelFit& fit) {
  const auto best = MaximizeTraceByEigensolver(m.cross, 0.5 * m.squares);
  if (!best) return false;
  const Eigen::Quaterniond& q = best->rotation;
  fit.q = {q.x(), q.y(), q.z(), q.w()};
  fit.trace = best->trace;
  fit.mirrored_trace = best->mirrored_trace;
  fit.translation = m.mean_b - Rotate(MakeRotationMatrix(fit.q), m.mean_a);
  return true;
}

KabschOutcome CheckFit(const KernelFit& kernel, double squares) {
  KabschFit fit;
  fit.sum_squares = std::max(0.0, squares - 2.0 * kernel.trace);
  fit.mirrored_sum_squares = std::max(0.0, squares - 2.0 * kernel.mirrored_trace);
  if (fit.sum_squares > kMirrorRatio * fit.mirrored_sum_squares + 1e-9 * squares) {
    return tl::unexpected(ErrorCode::kMirrored);
  }
  fit.b_from_a.rotation = ToQuaternion(kernel.q);
  fit.b_from_a.translation = {kernel.translation.x, kernel.translation.y, kernel.translation.z};
  return fit;
}

KabschOutcome FitPoints(std::span<const Eigen::Vector3d> points_in_b,
                        std::span<const Eigen::Vector3d> points_in_a,
                        std::span<const double> weights) {
  CentredMoments<double> moments;
  return Fit(PointSpans{points_in_b, points_in_a, weights}, moments);
}

KabschOutcome FitPairs(std::span<const Pair3d3d> pairs, KabschMoments& moments) {
  CentredMoments<double> m;
  KabschOutcome fit = Fit(WeightedPoints{pairs}, m);
  if (!fit) return fit;
  moments.weight = m.weight;
  moments.mean_in_lidar = {m.mean_a.x, m.mean_a.y, m.mean_a.z};
  moments.cross << m.cross.xx, m.cross.xy, m.cross.xz, m.cross.yx, m.cross.yy, m.cross.yz,
      m.cross.zx, m.cross.zy, m.cross.zz;
  moments.scatter = Dense(m.scatter);
  return fit;
}

Matrix6d KabschCovariance(const KabschMoments& moments, const Rigid3d& cam_from_lidar,
                          double variance) {
  const Eigen::Matrix3d r = cam_from_lidar.rotation.toRotationMatrix();
  const Eigen::Matrix3d m = r * moments.cross;
  const Eigen::Matrix3d inverse = TraceLess(0.5 * (m + m.transpose())).inverse();
  const Eigen::Matrix3d noise = TraceLess(r * moments.scatter * r.transpose());
  const Eigen::Matrix3d of_rotation = variance * (inverse * noise * inverse);
  // dt is the shift of the origin, which a rotation about the means moves.
  const Eigen::Matrix3d lever = Hat(r * moments.mean_in_lidar);
  Matrix6d covariance;
  covariance.topLeftCorner<3, 3>() = 0.5 * (of_rotation + of_rotation.transpose());
  covariance.bottomLeftCorner<3, 3>() = lever * covariance.topLeftCorner<3, 3>();
  covariance.topRightCorner<3, 3>() = covariance.bottomLeftCorner<3, 3>().transpose();
  covariance.bottomRightCorner<3, 3>() = covariance.bottomLeftCorner<3, 3>() * lever.transpose() +
                                         variance / moments.weight * Eigen::Matrix3d::Identity();
  return covariance;
}

Error ExplainKabsch(ErrorCode code, std::size_t count) {
  if (code == ErrorCode::kTooFewPairs) {
    return {code, fmt::format("kabsch needs at least 3 pairs, got {}", count)};
  }
  if (code == ErrorCode::kMirrored) {
    return {code,
            "one point set is a mirror image of the other: no rotation maps them; check the order "
            "of the corners and the sign of the axes"};
  }
  return {code,
          "the points of a sensor coincide or lie on one line, which leaves a rotation "
          "undetermined; use points that span a plane"};
}

Expected<KabschFit> FitKabsch(std::span<const Eigen::Vector3d> points_in_b,
                              std::span<const Eigen::Vector3d> points_in_a,
                              std::span<const double> weights) {
  const KabschOutcome fit = FitPoints(points_in_b, points_in_a, weights);
  if (!fit) return tl::unexpected<Error>(ExplainKabsch(fit.error(), points_in_a.size()));
  return *fit;
}

}  // namespace sextant
