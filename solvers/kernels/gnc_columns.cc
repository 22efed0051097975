// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/gnc_columns.h"

#include <algorithm>
#include <limits>

#include "solvers/kernels/column_kernel.h"

namespace sextant {
namespace {

SEXTANT_INLINE double LargestElement(const Vec8d& v) {
  double largest = 0.0;
  for (std::size_t i = 0; i < kSimdWidth; ++i) largest = v[i] > largest ? v[i] : largest;
  return largest;
}

// Padding is not a number, and then the comparison is false.
SEXTANT_MULTIVERSION double LargestFinite(const PairColumns& pairs, const ColumnPose& pose) {
  const Vec8d limit = BroadcastVec(std::numeric_limits<double>::max());
  Vec8d largest{};
  for (std::size_t at = 0; at < pairs.padded(); at += kSimdWidth) {
    const Vec8d squared = SquaredSigmas(pairs, pose, at);
    largest = squared <= limit ? Max(largest, squared) : largest;
  }
  return LargestElement(largest);
}

// Writes the weights at the pose and sums the pairs so weighted. Returns GncReweighting::unsettled.
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
  return LargestElement(unsettled);
}

}  // namespace

double LargestSquaredOf(const PairColumns& pairs, const Rigid3d& cam_from_lidar) {
  return LargestFinite(pairs, ColumnPoseOf(cam_from_lidar));
}

GncReweighting ReweightColumns(const PairColumns& pairs, const Rigid3d& cam_from_lidar,
                               const GncWeight& weight_of, std::span<double> weights) {
  ColumnFit fit(pairs);
  GncReweighting result;
  result.unsettled = Reweight(pairs, ColumnPoseOf(cam_from_lidar), weight_of, weights.data(), fit);
  result.fit = fit.pose();
  return result;
}

}  // namespace sextant
