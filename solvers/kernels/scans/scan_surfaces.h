// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "solvers/kernels/scans/scan_windows.h"

namespace sextant {

/// A plane normal . point = distance, fitted to points.
struct ScanPlane {
  std::array<double, 3> normal{};
  double distance = 0.0;
  /// Variance of one return along the normal [m^2]. The variance of the plane itself at `point` is
  /// this times point^T inverse_moments point.
  double variance_m2 = 0.0;
  std::array<double, 6> inverse_moments{};  ///< xx, xy, xz, yy, yz, zz [1/m^2].
};

/// The surfaces of a scan: planes by cell, and the centroid of the points of each cell that is on
/// one.
///
/// A cell takes the plane of the window around it where that is flat to the noise, else of the
/// flattest window that contains the cell (Kuwahara et al. 1976), so that planes reach up to edges
/// but not across. The noise is estimated from the scan itself: a quantile of the windows'
/// residuals.
class ScanSurfaces {
 public:
  explicit ScanSurfaces(const ScanWindows& windows);

  const ScanCells& cells() const { return cells_; }

  /// Sigma of a return along its ray [m].
  double range_sigma_m() const { return range_sigma_m_; }

  /// By cell number; the last one belongs to no cell.
  const std::vector<ScanPlane>& planes() const { return planes_; }
  /// The number of the plane that nothing matches.
  std::int32_t no_plane() const { return static_cast<std::int32_t>(planes_.size()) - 1; }

  /// Centroids of cells as a structure of arrays, padded to a multiple of kSimdWidth with patches
  /// of weight 0.
  struct Patches {
    std::array<std::vector<double>, 3> middle;
    std::array<std::vector<double>, 3> normal;
    std::vector<double> inverse_count;  ///< 1 / number of points in the cell.
  };
  const Patches& patches() const { return patches_; }
  std::size_t patch_count() const { return patch_count_; }

 private:
  void ChoosePlanes(const ScanWindows& windows);
  void AddPatch(std::size_t cell);
  void Pad();

  ScanCells cells_;
  double range_sigma_m_ = 0.0;
  std::vector<ScanPlane> planes_;
  Patches patches_;
  std::size_t patch_count_ = 0;
};

}  // namespace sextant
