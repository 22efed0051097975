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
/// m . p = 1 with m = (sum p p^T)^-1 sum p. That is least squares in ranges, whose noise it is, as
/// directions are exact: residual m . p - 1 is range noise by m . direction.
class ScanWindows {
 public:
  /// Points [m] seen from their frame's origin, finite. Requires at least one.
  ScanWindows(std::span<const Eigen::Vector3d> points, double cell_rad);

  const ScanCells& cells() const { return cells_; }

  /// By the cell in their middle, and kSimdWidth more that mean nothing.
  struct Planes {
    std::array<std::vector<double>, 3> plane;    ///< m of m . p = 1.
    std::array<std::vector<double>, 6> inverse;  ///< Of sum p p^T: xx, xy, xz, yy, yz, zz.
    std::vector<double> range_variance;          ///< Infinite where there is no plane.
    std::vector<double> cosine2;                 ///< Squared, of the angle of incidence.
  };
  const Planes& planes() const { return planes_; }

  /// Whether the window is a plane that is not seen too flatly to tell the noise of its ranges.
  bool TellsNoise(std::size_t cell) const;

  /// A low quantile of range_variance [m^2] over the windows that tell it among `count` cells from
  /// `first` on: most windows are flat, but not all. 0 where fewer than `least` tell it.
  double NoiseVariance(std::size_t first, std::size_t count, std::size_t least) const;

  /// Takes ranges to be longer than they should by these [m], row by row, and fits anew.
  void TakeOff(std::span<const double> offsets_m);

 private:
  void Fit();

  ScanCells cells_;
  Planes planes_;
};

}  // namespace sextant
