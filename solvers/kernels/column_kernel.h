// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "solvers/kernels/kabsch_kernel.h"
#include "solvers/kernels/kabsch_moments.h"
#include "solvers/kernels/pair_columns.h"
#include "solvers/kernels/trace_formula.h"

namespace sextant {

/// Shared by the kernels over PairColumns.

/// Indices of columns: the first of three for each frame, and those of the variances.
inline constexpr int kCamColumn = 0;
inline constexpr int kLidarColumn = 3;
inline constexpr int kVarianceColumn = 6;
inline constexpr int kInverseVarianceColumn = 7;

/// Eight points of the frame whose columns begin at `first`.
SEXTANT_INLINE Point3<Vec8d> PointsAt(const PairColumns& pairs, int first, std::size_t place) {
  return {LoadVec(pairs.Column(first) + place), LoadVec(pairs.Column(first + 1) + place),
          LoadVec(pairs.Column(first + 2) + place)};
}

SEXTANT_INLINE Point3<double> PointOf(const PairColumns& pairs, int first, std::size_t place) {
  return {pairs.Column(first)[place], pairs.Column(first + 1)[place],
          pairs.Column(first + 2)[place]};
}

/// cam_from_lidar.
struct ColumnPose {
  RotationMatrix<double> r;
  Point3<double> t;
};

inline ColumnPose ColumnPoseOf(const Rigid3d& cam_from_lidar) {
  const Eigen::Quaterniond& q = cam_from_lidar.rotation;
  return {MakeRotationMatrix(Vector4<double>{q.x(), q.y(), q.z(), q.w()}),
          PointAt(cam_from_lidar.translation)};
}

/// r_i^2 [sigma^2] of eight pairs; NaN for padding.
SEXTANT_INLINE Vec8d SquaredSigmas(const PairColumns& pairs, const ColumnPose& pose,
                                   std::size_t at) {
  const Point3<Vec8d> cam = PointsAt(pairs, kCamColumn, at);
  const Point3<Vec8d> p = PointsAt(pairs, kLidarColumn, at);
  const Vec8d x = cam.x - (pose.r.xx * p.x + pose.r.xy * p.y + pose.r.xz * p.z + pose.t.x);
  const Vec8d y = cam.y - (pose.r.yx * p.x + pose.r.yy * p.y + pose.r.yz * p.z + pose.t.y);
  const Vec8d z = cam.z - (pose.r.zx * p.x + pose.r.zy * p.y + pose.r.zz * p.z + pose.t.z);
  return (x * x + y * y + z * z) * LoadVec(pairs.Column(kInverseVarianceColumn) + at);
}

/// Least squares on weighted pairs: sums relative to the first pair, then the closed form.
class ColumnFit {
 public:
  SEXTANT_INLINE explicit ColumnFit(const PairColumns& pairs)
      : origin_a_(PointOf(pairs, kLidarColumn, 0)), origin_b_(PointOf(pairs, kCamColumn, 0)) {}

  /// Adds eight pairs with their weights, without those that are masked out.
  SEXTANT_INLINE void Add(const PairColumns& pairs, std::size_t at, const Mask8& counts,
                          const Vec8d& weights, PairMomentSums<Vec8d>& sums) const {
    const Vec8d none{};
    const Point3<Vec8d> a = PointsAt(pairs, kLidarColumn, at) - origin_a_;
    const Point3<Vec8d> b = PointsAt(pairs, kCamColumn, at) - origin_b_;
    sums.Add<true, false>({counts ? a.x : none, counts ? a.y : none, counts ? a.z : none},
                          {counts ? b.x : none, counts ? b.y : none, counts ? b.z : none},
                          counts ? weights : none);
  }

  SEXTANT_INLINE void Finish(const PairMomentSums<Vec8d>& sums) {
    const PairMomentSums<double> sum = SumOf<true, false>(sums);
    CentredMoments<double>& m = moments_;
    m = Centre<false>(sum, sum.weight);
    m.mean_a = {m.mean_a.x + origin_a_.x, m.mean_a.y + origin_a_.y, m.mean_a.z + origin_a_.z};
    m.mean_b = {m.mean_b.x + origin_b_.x, m.mean_b.y + origin_b_.y, m.mean_b.z + origin_b_.z};
    const std::optional<TraceMaximum> best = MaximizeTraceByFormula(m.cross, 0.5 * m.squares);
    fitted_ = best.has_value();
    if (!best) return;
    fit_ = {best->q, m.mean_b - Rotate(best->matrix, m.mean_a), best->trace, best->mirrored_trace};
  }

  /// None where the pairs do not determine a pose.
  std::optional<Rigid3d> pose() {
    if (!fitted_ && !FitByEigensolver(moments_, fit_)) return std::nullopt;
    return Rigid3d{ToQuaternion(fit_.q),
                   {fit_.translation.x, fit_.translation.y, fit_.translation.z}};
  }

 private:
  Point3<double> origin_a_;
  Point3<double> origin_b_;
  CentredMoments<double> moments_{};
  KernelFit fit_{};
  bool fitted_ = false;
};

}  // namespace sextant
