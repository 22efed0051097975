// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/gnc_columns.h"

#include <cmath>
#include <vector>

#include "solvers/kernels/column_kernel.h"

namespace sextant {
namespace {

SEXTANT_MULTIVERSION double LargestSquared(const PairColumns& pairs, const ColumnPose& pose) {
  Vec8d largest{};
  for (std::size_t at = 0; at < pairs.padded(); at += kSimdWidth) {
    // The first where the second is not a number.
    largest = Max(largest, SquaredSigmas(pairs, pose, at));
  }
  double most = 0.0;
  for (std::size_t lane = 0; lane < kSimdWidth; ++lane) {
    most = largest[lane] > most ? largest[lane] : most;
  }
  return most;
}

// New weights at the pose, in place, and sums of the pairs so weighed. How far the weights are from
// being settled: the largest of their distances from 0 or 1 and of their changes.
SEXTANT_MULTIVERSION double Reweight(const PairColumns& pairs, const ColumnPose& pose,
                                     const GncWeight& by, double* weights, ColumnFit& fit) {
  const Vec8d none{};
  const Vec8d one = BroadcastVec(1.0);
  PairMomentSums<Vec8d> sums{};
  Vec8d unsettled{};
  for (std::size_t at = 0; at < pairs.padded(); at += kSimdWidth) {
    const Vec8d squared = SquaredSigmas(pairs, pose, at);
    const Vec8d between = Sqrt(by.scale / squared) - by.mu;
    const Mask8 counts = squared < by.none;
    const Vec8d faded = squared <= by.full ? one : between;
    const Vec8d weight = counts ? faded : none;
    unsettled = Max(unsettled, Min(weight, one - weight));
    unsettled = Max(unsettled, Abs(weight - LoadVec(weights + at)));
    StoreVec(weight, weights + at);
    fit.Add(pairs, at, counts, weight * LoadVec(pairs.Column(kInverseVarianceColumn) + at), sums);
  }
  fit.Finish(sums);
  double most = 0.0;
  for (std::size_t lane = 0; lane < kSimdWidth; ++lane) {
    most = unsettled[lane] > most ? unsettled[lane] : most;
  }
  return most;
}

}  // namespace

double FirstGncMu(double largest_squared, double max_squared) {
  return largest_squared <= max_squared ? 0.0 : max_squared / (2.0 * largest_squared - max_squared);
}

std::optional<GncPose> AnnealInColumns(const PairColumns& pairs, const Rigid3d& start,
                                       const GncSchedule& schedule) {
  GncPose result{.cam_from_lidar = start, .iterations = 1};
  const double largest = LargestSquared(pairs, ColumnPoseOf(start));
  if (!std::isfinite(largest)) return std::nullopt;
  double mu = FirstGncMu(largest, schedule.max_squared);
  if (mu <= 0.0) return result;
  std::vector<double> weights(pairs.padded(), 1.0);
  for (; result.iterations < schedule.max_iterations; ++result.iterations) {
    ColumnFit fit(pairs);
    const double unsettled = Reweight(pairs, ColumnPoseOf(result.cam_from_lidar),
                                      GncWeight(schedule.max_squared, mu), weights.data(), fit);
    if (unsettled < kGncBinary) break;
    const std::optional<Rigid3d> pose = fit.pose();
    if (!pose) return std::nullopt;
    result.cam_from_lidar = *pose;
    mu *= schedule.mu_factor;
  }
  return result;
}

}  // namespace sextant
