// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/calibration_problem.h"
#include "solvers/kernels/kabsch.h"

namespace sextant {

/// 3D-3D pairs with isotropic noise as columns of numbers, for SIMD vectors of 8 doubles.
///
/// Blocks of 64: number 8 k + j of a block belongs to its pair 8 j + k, which puts the bits of a
/// block's comparisons in order. The last block is padded with NaN, which agrees with nothing.
class PairColumns {
 public:
  static constexpr std::size_t kBlock = 64;

  /// Requires that no pair states a covariance; without a sigma the unit of residuals is 1 m.
  explicit PairColumns(std::span<const Pair3d3d> pairs);

  std::size_t size() const { return size_; }
  std::size_t padded() const { return padded_; }

  /// Column of the camera's x, y, z, of the LiDAR's, of the variance and of its inverse.
  const double* Column(int which) const {
    return numbers_.data() + static_cast<std::size_t>(which) * padded_;
  }

  /// The index of a pair's numbers in a column.
  static std::size_t Place(std::size_t pair) {
    const std::size_t in_block = pair % kBlock;
    return pair - in_block + 8 * (in_block % 8) + in_block / 8;
  }

 private:
  std::size_t size_;
  std::size_t padded_;
  std::vector<double> numbers_;
};

/// sum_i min(r_i^2, max_squared), r_i in sigmas: the MSAC cost.
double TruncatedCost(const PairColumns& pairs, const Rigid3d& cam_from_lidar, double max_squared);

/// Least squares on the pairs with r_i^2 <= max_squared at `cam_from_lidar`.
struct InlierFit {
  Rigid3d cam_from_lidar;
  double cost = 0.0;    ///< TruncatedCost at the given pose.
  int inliers = 0;      ///< Number of inliers of the given pose.
  bool fitted = false;  ///< False where the inliers do not determine a pose.
};
InlierFit FitInliers(const PairColumns& pairs, const Rigid3d& cam_from_lidar, double max_squared);

/// Writes r_i^2 of every pair. Shape: `squared` has as many numbers as there are pairs.
void SquaredResidualsOf(const PairColumns& pairs, const Rigid3d& cam_from_lidar,
                        std::span<double> squared);

/// Writes the indices, ascending, of the pairs with r_i^2 <= max_squared.
void InliersOf(const PairColumns& pairs, const Rigid3d& cam_from_lidar, double max_squared,
               std::vector<int>& inliers);

}  // namespace sextant
