// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "solvers/kernels/scans/scan_windows.h"

namespace sextant {

/// A plane normal . point = distance, as known from some points.
struct ScanPlane {
  std::array<double, 3> normal{};
  double distance = 0.0;
  /// Of a point's distance from it: noise of one return along the normal, squared [m^2]. Where the
  /// plane itself is at `point` has that times point^T inverse_moments point.
  double variance_m2 = 0.0;
  std::array<double, 6> inverse_moments{};  ///< xx, xy, xz, yy, yz, zz [1/m^2].
};

/// What a scan shows of surfaces: planes by cell, and the middle of the points of each cell that is
/// on one.
///
/// A cell takes the plane of the window round it where that is flat to the noise, else of the
/// flattest window with the cell in it (Kuwahara et al. 1976): so planes reach up to edges and not
/// across. The noise is the scan's own: a quantile of the windows' residuals.
class ScanSurfaces {
 public:
  explicit ScanSurfaces(const ScanWindows& windows);

  const ScanCells& cells() const { return cells_; }

  /// Sigma of a return along its ray [m].
  double range_sigma_m() const { return range_sigma_m_; }

  /// By number of the cell; the last belongs to no cell.
  const std::vector<ScanPlane>& planes() const { return planes_; }
  /// The number of a plane that nothing matches.
  std::int32_t no_plane() const { return static_cast<std::int32_t>(planes_.size()) - 1; }

  /// Middles of cells, structure of arrays, filled up to a multiple of kSimdWidth with patches of
  /// weight 0.
  struct Patches {
    std::array<std::vector<double>, 3> middle;
    std::array<std::vector<double>, 3> normal;
    std::vector<double> inverse_count;  ///< One by the points that the middle is of.
  };
  const Patches& patches() const { return patches_; }
  std::size_t patch_count() const { return patch_count_; }

 private:
  void ChoosePlanes(const ScanWindows& windows);
  void AddPatch(std::size_t cell);
  void FillUp();

  ScanCells cells_;
  double range_sigma_m_ = 0.0;
  std::vector<ScanPlane> planes_;
  Patches patches_;
  std::size_t patch_count_ = 0;
};

}  // namespace sextant
