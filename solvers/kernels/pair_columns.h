// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/calibration_problem.h"
#include "solvers/kernels/kabsch.h"
#include "solvers/kernels/pair_terms.h"

namespace sextant {

/// 3D-3D pairs of isotropic noise as columns of numbers, so that eight are judged side by side.
///
/// Blocks of 64: number 8 k + lane of a block belongs to its pair 8 lane + k, which puts the bits
/// of a block's comparisons in order. The last block is filled up with pairs that are not numbers
/// and agree with nothing.
class PairColumns {
 public:
  static constexpr std::size_t kBlock = 64;

  /// Requires that no pair states a covariance; one that states no sigma gets the assumed.
  PairColumns(std::span<const Pair3d3d> pairs, const AssumedNoise& assumed);

  std::size_t size() const { return size_; }
  std::size_t padded() const { return padded_; }

  /// Column of the camera's x, y, z, of the LiDAR's, of the variance and of its inverse.
  const double* Column(int which) const {
    return numbers_.data() + static_cast<std::size_t>(which) * padded_;
  }

  /// Where the numbers of a pair stand in a column.
  static std::size_t Place(std::size_t pair) {
    const std::size_t in_block = pair % kBlock;
    return pair - in_block + 8 * (in_block % 8) + in_block / 8;
  }

 private:
  std::size_t size_;
  std::size_t padded_;
  std::vector<double> numbers_;
};

/// sum_i min(r_i^2, max_squared), r_i in sigmas: PoseScorer::Cost.
double TruncatedCost(const PairColumns& pairs, const Rigid3d& cam_from_lidar, double max_squared);

/// Least squares on the pairs with r_i^2 <= max_squared at `cam_from_lidar`.
struct InlierFit {
  Rigid3d cam_from_lidar;
  double cost = 0.0;    ///< TruncatedCost at the pose that was given.
  int inliers = 0;      ///< There, too.
  bool fitted = false;  ///< False where the inliers do not determine a pose.
};
InlierFit FitInliers(const PairColumns& pairs, const Rigid3d& cam_from_lidar, double max_squared);

/// Indices, ascending, of the pairs with r_i^2 <= max_squared.
std::vector<int> InliersOf(const PairColumns& pairs, const Rigid3d& cam_from_lidar,
                           double max_squared);

}  // namespace sextant
