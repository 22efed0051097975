// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/pair_columns.h"

#include <algorithm>
#include <limits>

#include "solvers/kernels/bit_graph.h"
#include "solvers/kernels/column_kernel.h"

namespace sextant {
namespace {

constexpr int kColumns = 8;
constexpr std::size_t kColumnBlock = PairColumns::kBlock;

// Includes the padding, whose residual is not a number and costs as an outlier's.
SEXTANT_MULTIVERSION double SumTruncated(const PairColumns& pairs, const ColumnPose& pose,
                                         double max_squared) {
  const Vec8d most = BroadcastVec(max_squared);
  Vec8d cost{};
  for (std::size_t at = 0; at < pairs.padded(); at += kSimdWidth) {
    const Vec8d squared = SquaredSigmas(pairs, pose, at);
    cost += squared < most ? squared : most;
  }
  return HorizontalSum(cost);
}

// Bit i of a word is set where pair i of its block is an inlier. `end` is that of the last block.
SEXTANT_MULTIVERSION void MarkInliers(const PairColumns& pairs, const ColumnPose& pose,
                                      double max_squared, std::size_t begin, std::size_t end,
                                      std::uint64_t* words) {
  const Mask8 shifts = {0, 8, 16, 24, 32, 40, 48, 56};
  for (std::size_t block = begin; block < end; block += kColumnBlock) {
    Mask8 bits{};
    for (std::size_t k = kSimdWidth; k-- > 0;) {
      const Mask8 is_inlier = SquaredSigmas(pairs, pose, block + kSimdWidth * k) <= max_squared;
      bits = bits + bits - is_inlier;
    }
    bits <<= shifts;
    *words++ = static_cast<std::uint64_t>(HorizontalOr(bits));
  }
}

// The squared residuals of the 64 pairs from `begin` on, in the order of the columns.
SEXTANT_MULTIVERSION void SquareBlock(const PairColumns& pairs, const ColumnPose& pose,
                                      std::size_t begin, double* squared) {
  for (std::size_t at = 0; at < kColumnBlock; at += kSimdWidth) {
    StoreVec(SquaredSigmas(pairs, pose, begin + at), squared + at);
  }
}

struct InlierSums {
  double cost = 0.0;
  double count = 0.0;
};

SEXTANT_MULTIVERSION void SumInliers(const PairColumns& pairs, const ColumnPose& pose,
                                     double max_squared, InlierSums& result, ColumnFit& fit) {
  const Vec8d most = BroadcastVec(max_squared);
  const Vec8d none{};
  PairMomentSums<Vec8d> sums{};
  Vec8d cost{};
  Vec8d count{};
  for (std::size_t at = 0; at < pairs.padded(); at += kSimdWidth) {
    const Vec8d squared = SquaredSigmas(pairs, pose, at);
    const Mask8 is_inlier = squared <= most;
    cost += is_inlier ? squared : most;
    count += is_inlier ? none + 1.0 : none;
    fit.Add(pairs, at, is_inlier, LoadVec(pairs.Column(kInverseVarianceColumn) + at), sums);
  }
  result.cost = HorizontalSum(cost);
  result.count = HorizontalSum(count);
  fit.Finish(sums);
}

double CostOfPadding(const PairColumns& pairs, double max_squared) {
  return static_cast<double>(pairs.padded() - pairs.size()) * max_squared;
}

}  // namespace

PairColumns::PairColumns(std::span<const Pair3d3d> pairs)
    : size_(pairs.size()),
      padded_((pairs.size() + kColumnBlock - 1) / kColumnBlock * kColumnBlock),
      numbers_(kColumns * padded_) {
  const auto set = [this](int column, std::size_t place, double value) {
    numbers_[static_cast<std::size_t>(column) * padded_ + place] = value;
  };
  for (std::size_t i = 0; i < size_; ++i) {
    const Pair3d3d& pair = pairs[i];
    const std::size_t place = Place(i);
    for (int axis = 0; axis < 3; ++axis) {
      set(kCamColumn + axis, place, pair.point_in_cam[axis]);
      set(kLidarColumn + axis, place, pair.point_in_lidar[axis]);
    }
    const double sigma = pair.sigma_m > 0.0 ? pair.sigma_m : 1.0;
    set(kVarianceColumn, place, sigma * sigma);
    set(kInverseVarianceColumn, place, 1.0 / (sigma * sigma));
  }
  for (std::size_t i = size_; i < padded_; ++i) {
    for (int column = 0; column < kColumns; ++column) {
      set(column, Place(i), std::numeric_limits<double>::quiet_NaN());
    }
  }
}

double TruncatedCost(const PairColumns& pairs, const Rigid3d& cam_from_lidar, double max_squared) {
  return SumTruncated(pairs, ColumnPoseOf(cam_from_lidar), max_squared) -
         CostOfPadding(pairs, max_squared);
}

InlierFit FitInliers(const PairColumns& pairs, const Rigid3d& cam_from_lidar, double max_squared) {
  InlierSums sum;
  ColumnFit fit(pairs);
  SumInliers(pairs, ColumnPoseOf(cam_from_lidar), max_squared, sum, fit);
  InlierFit result;
  result.cost = sum.cost - CostOfPadding(pairs, max_squared);
  result.inliers = static_cast<int>(sum.count);
  if (result.inliers < 3) return result;
  const std::optional<Rigid3d> pose = fit.pose();
  result.fitted = pose.has_value();
  if (pose) result.cam_from_lidar = *pose;
  return result;
}

void SquaredResidualsOf(const PairColumns& pairs, const Rigid3d& cam_from_lidar,
                        std::span<double> squared) {
  double block[kColumnBlock];
  const ColumnPose pose = ColumnPoseOf(cam_from_lidar);
  for (std::size_t begin = 0; begin < pairs.size(); begin += kColumnBlock) {
    SquareBlock(pairs, pose, begin, block);
    const std::size_t end = std::min(begin + kColumnBlock, pairs.size());
    for (std::size_t i = begin; i < end; ++i) squared[i] = block[PairColumns::Place(i) - begin];
  }
}

void InliersOf(const PairColumns& pairs, const Rigid3d& cam_from_lidar, double max_squared,
               std::vector<int>& inliers) {
  constexpr std::size_t kWords = 16;
  std::uint64_t words[kWords];
  const ColumnPose pose = ColumnPoseOf(cam_from_lidar);
  inliers.clear();
  inliers.reserve(pairs.size());
  for (std::size_t begin = 0; begin < pairs.padded(); begin += kWords * kColumnBlock) {
    const std::size_t end = std::min(begin + kWords * kColumnBlock, pairs.padded());
    MarkInliers(pairs, pose, max_squared, begin, end, words);
    ForEachBit(words, (end - begin) / kColumnBlock,
               [&](int bit) { inliers.push_back(static_cast<int>(begin) + bit); });
  }
}

}  // namespace sextant
