// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "solvers/kernels/scans/scan_cells.h"

namespace sextant {

/// Planes fitted to every window of 3 x 3 cells of a scan.
///
/// m . p = 1 with m = (sum p p^T)^-1 sum p. This is least squares in ranges, which have all the
/// noise, as directions are exact: the residual m . p - 1 is the range noise times m . direction.
class ScanWindows {
 public:
  /// Points [m] in the sensor's frame, finite. Requires at least one.
  ScanWindows(std::span<const Eigen::Vector3d> points, double cell_rad);

  const ScanCells& cells() const { return cells_; }

  /// By the cell in the middle of the window; the last kSimdWidth elements are padding.
  struct Planes {
    std::array<std::vector<double>, 3> plane;    ///< m of m . p = 1.
    std::array<std::vector<double>, 6> inverse;  ///< (sum p p^T)^-1: xx, xy, xz, yy, yz, zz.
    std::vector<double> range_variance;          ///< Infinite where there is no plane.
    std::vector<double> cosine2;                 ///< Squared cosine of the angle of incidence.
  };
  const Planes& planes() const { return planes_; }

  /// Whether the window is a plane whose angle of incidence is small enough to estimate the noise
  /// of its ranges.
  bool CanEstimateNoise(std::size_t cell) const;

  /// A low quantile of range_variance [m^2] over the windows that can estimate it among `count`
  /// cells from `first` on: most windows are flat, but not all. 0 where fewer than `min_windows`
  /// can.
  double NoiseVariance(std::size_t first, std::size_t count, std::size_t min_windows) const;

  /// Subtracts an offset [m] from the ranges of each row and fits again. Shape: one offset per row.
  void SubtractOffsets(std::span<const double> offsets_m);

 private:
  void Fit();

  ScanCells cells_;
  Planes planes_;
};

}  // namespace sextant
