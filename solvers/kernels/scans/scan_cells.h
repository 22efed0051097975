// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/simd.h"

namespace sextant {

/// Moments of the points in one or more cells: count and sums [m, m^2].
struct CellSums {
  static constexpr std::size_t kCount = 0;
  static constexpr std::size_t kFirst = 1;   ///< x, y, z.
  static constexpr std::size_t kSecond = 4;  ///< xx, xy, xz, yy, yz, zz.
  static constexpr std::size_t kSize = 10;
  alignas(16) std::array<double, kSize> of{};
};

/// A scan divided into cells as its sensor sees it: rows of elevation, columns of azimuth. Takes
/// one pass over the points, which may be in any order.
///
/// Rows follow the rings: rings are recognised by the gaps between their elevations, and a row is
/// the smallest number of whole rings that is `cell_rad` high, so that no row has half a ring. If
/// there are no rings, rows are `cell_rad` high. Points more than 76 degrees off the plane that the
/// sensor sweeps are left out.
///
/// Azimuth is about that axis of the frame which the points are farthest from: z for a LiDAR, y for
/// a camera.
class ScanCells {
 public:
  /// Points [m] in the sensor's frame, finite. Requires at least one.
  ScanCells(std::span<const Eigen::Vector3d> points, double cell_rad);

  double cell_rad() const { return cell_rad_; }
  int rows() const { return rows_; }
  int columns() const { return columns_; }
  /// Row by row.
  const std::vector<CellSums>& sums() const { return sums_; }

  /// Tangent of the elevation of a row, 0 for level; the root mean square where it has several
  /// rings.
  double SlopeOf(int row) const;

  /// Subtracts an offset [m] from the ranges of each row. Within a cell all points are assumed to
  /// be at the root mean square of its ranges. Shape: one offset per row.
  void SubtractOffsets(std::span<const double> offsets_m);

  /// Writes the cell numbers of eight points; `outside` where there is no row.
  SEXTANT_INLINE void CellsOf(const std::array<Vec8d, 3>& points, std::int32_t outside,
                              std::int32_t* cells) const {
    const Vec8d x = points[axes_[0]];
    const Vec8d y = points[axes_[1]];
    std::array<double, kSimdWidth> slopes;
    StoreVec(SlopesOf(x, y, points[axes_[2]]), slopes.data());
    ColumnsOf(x, y, cells);
    for (std::size_t i = 0; i < kSimdWidth; ++i) {
      const std::int32_t row = row_of_bin_[static_cast<std::size_t>(BinOf(slopes[i]))];
      cells[i] = row < 0 ? outside : row * columns_ + cells[i];
    }
  }

 private:
  static constexpr int kBins = 2048;
  static constexpr double kSteepest = 4.0;

  // Tangents of elevations, clamped to kSteepest.
  static SEXTANT_INLINE Vec8d SlopesOf(const Vec8d& x, const Vec8d& y, const Vec8d& z) {
    const Vec8d level = Max(Sqrt(x * x + y * y), BroadcastVec(1e-12));
    return Max(Min(z / level, BroadcastVec(kSteepest)), BroadcastVec(-kSteepest));
  }

  // Azimuths in turns, from 0 to 1, with errors up to 0.001, which only shift the borders of cells.
  static SEXTANT_INLINE Vec8d TurnsOf(const Vec8d& x, const Vec8d& y) {
    const Vec8d right = Abs(x);
    const Vec8d up = Abs(y);
    const Vec8d ratio = Min(right, up) / Max(Max(right, up), BroadcastVec(1e-12));
    const Vec8d eighth = ratio * (0.125 + 0.0434 * (1.0 - ratio));
    const Vec8d quarter = up > right ? 0.25 - eighth : eighth;
    const Vec8d half = x < 0.0 ? 0.5 - quarter : quarter;
    return y < 0.0 ? 1.0 - half : half;
  }

  SEXTANT_INLINE void ColumnsOf(const Vec8d& x, const Vec8d& y, std::int32_t* columns) const {
    const Vec8d turns = TurnsOf(x, y) * static_cast<double>(columns_);
    for (std::size_t i = 0; i < kSimdWidth; ++i) {
      columns[i] = std::min(static_cast<std::int32_t>(turns[i]), columns_ - 1);
    }
  }

  // 0 to kBins + 1; the first and the last are outside.
  SEXTANT_INLINE int BinOf(double slope) const {
    const double bin = (slope - first_slope_) * bins_per_slope_ + 1.0;
    return static_cast<int>(std::clamp(bin, 0.0, kBins + 1.0));
  }

  void ChooseAxes(std::span<const Eigen::Vector3d> points);
  void FindBearings(std::span<const Eigen::Vector3d> points, double* slopes,
                    std::int32_t* columns) const;
  void ChooseRows(std::span<const double> slopes, double cell_rad);

  std::array<std::size_t, 3> axes_{0, 1, 2};
  double cell_rad_;
  int rows_ = 0;
  int columns_ = 0;
  double first_slope_ = 0.0;
  double bins_per_slope_ = 0.0;
  std::array<std::int16_t, kBins + 2> row_of_bin_{};  ///< -1 outside.
  std::vector<CellSums> sums_;
};

}  // namespace sextant
