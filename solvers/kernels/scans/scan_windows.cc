// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/scans/scan_windows.h"

#include <algorithm>
#include <cmath>

namespace sextant {
namespace {

constexpr double kMinPoints = 12.0;     ///< In a window.
constexpr double kNoiseQuantile = 0.3;  ///< Most windows are flat, but not all.
constexpr double kMinNoise_m = 1e-4;    ///< No LiDAR is better; exact data would divide by 0.
constexpr double kSteepCosine2 = 0.03;  ///< Below this a window cannot estimate the noise.
constexpr double kMinCosine2 = 0.02;    ///< Below this, more than range noise moves points.

// The sums of cells as a structure of arrays, with a border of one cell: it wraps around in azimuth
// and is empty above and below.
class CellPlanes {
 public:
  explicit CellPlanes(const ScanCells& cells)
      : stride_(static_cast<std::size_t>(cells.columns()) + 2 + kSimdWidth) {
    const auto rows = static_cast<std::size_t>(cells.rows());
    const auto columns = static_cast<std::size_t>(cells.columns());
    for (std::vector<double>& sums : of_) sums.resize((rows + 2) * stride_);
    for (std::size_t row = 0; row < rows; ++row) {
      for (std::size_t column = 0; column < columns + 2; ++column) {
        const std::size_t cell = row * columns + (column + columns - 1) % columns;
        const std::size_t at = (row + 1) * stride_ + column;
        for (std::size_t k = 0; k < of_.size(); ++k) of_[k][at] = cells.sums()[cell].of[k];
      }
    }
  }

  // Sums over the 3 x 3 cells around each of eight cells of a row.
  SEXTANT_INLINE Vec8d Window(std::size_t k, std::size_t row, std::size_t column) const {
    Vec8d sum = BroadcastVec(0.0);
    for (std::size_t r = 0; r < 3; ++r) {
      const double* at = of_[k].data() + (row + r) * stride_ + column;
      sum += (LoadVec(at) + LoadVec(at + 1)) + LoadVec(at + 2);
    }
    return sum;
  }

 private:
  std::size_t stride_;
  std::array<std::vector<double>, CellSums::kSize> of_;
};

// Eight windows.
struct WindowFit {
  std::array<Vec8d, 3> plane;
  std::array<Vec8d, 6> inverse;
  Vec8d range_variance;
  Vec8d cosine2;
};

SEXTANT_INLINE WindowFit FitWindows(const CellPlanes& cells, std::size_t row, std::size_t column) {
  const Vec8d count = cells.Window(CellSums::kCount, row, column);
  std::array<Vec8d, 3> s;
  std::array<Vec8d, 6> q;
  for (std::size_t k = 0; k < 3; ++k) s[k] = cells.Window(CellSums::kFirst + k, row, column);
  for (std::size_t k = 0; k < 6; ++k) q[k] = cells.Window(CellSums::kSecond + k, row, column);
  WindowFit fit;
  std::array<Vec8d, 6>& i = fit.inverse;  // The adjugate first.
  i[0] = q[3] * q[5] - q[4] * q[4];
  i[1] = q[2] * q[4] - q[1] * q[5];
  i[2] = q[1] * q[4] - q[2] * q[3];
  i[3] = q[0] * q[5] - q[2] * q[2];
  i[4] = q[1] * q[2] - q[0] * q[4];
  i[5] = q[0] * q[3] - q[1] * q[1];
  const Vec8d determinant = q[0] * i[0] + q[1] * i[1] + q[2] * i[2];
  const Mask8 usable = (determinant > 0.0) & (count >= kMinPoints);
  const Vec8d scale = 1.0 / (usable ? determinant : BroadcastVec(1.0));
  for (Vec8d& element : i) element *= scale;
  std::array<Vec8d, 3>& m = fit.plane;
  m[0] = i[0] * s[0] + i[1] * s[1] + i[2] * s[2];
  m[1] = i[1] * s[0] + i[3] * s[1] + i[4] * s[2];
  m[2] = i[2] * s[0] + i[4] * s[1] + i[5] * s[2];
  const Vec8d m_s = m[0] * s[0] + m[1] * s[1] + m[2] * s[2];
  const Vec8d m_m = m[0] * m[0] + m[1] * m[1] + m[2] * m[2];
  const Vec8d s_s = s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
  const Mask8 has_plane = usable & (m_m > 0.0) & (s_s > 0.0);
  const Vec8d squares = Max(count - m_s, BroadcastVec(0.0));
  fit.cosine2 =
      Max(m_s * m_s / (has_plane ? m_m * s_s : BroadcastVec(1.0)), BroadcastVec(kMinCosine2));
  const Vec8d variance =
      squares / ((has_plane ? (count - 3.0) * m_m : BroadcastVec(1.0)) * fit.cosine2);
  fit.range_variance = has_plane ? variance : BroadcastVec(HUGE_VAL);
  return fit;
}

// Elements beyond the end of a row are overwritten by the next row; the last ones are padding.
SEXTANT_MULTIVERSION
void FitAllWindows(const CellPlanes& cells, std::size_t rows, std::size_t columns,
                   ScanWindows::Planes& windows) {
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; column += kSimdWidth) {
      const WindowFit fit = FitWindows(cells, row, column);
      const std::size_t at = row * columns + column;
      for (std::size_t k = 0; k < 3; ++k) StoreVec(fit.plane[k], windows.plane[k].data() + at);
      for (std::size_t k = 0; k < 6; ++k) {
        StoreVec(fit.inverse[k], windows.inverse[k].data() + at);
      }
      StoreVec(fit.range_variance, windows.range_variance.data() + at);
      StoreVec(fit.cosine2, windows.cosine2.data() + at);
    }
  }
}

}  // namespace

ScanWindows::ScanWindows(std::span<const Eigen::Vector3d> points, double cell_rad)
    : cells_(points, cell_rad) {
  const std::size_t size = cells_.sums().size() + kSimdWidth;
  for (std::vector<double>& m : planes_.plane) m.resize(size);
  for (std::vector<double>& i : planes_.inverse) i.resize(size);
  planes_.range_variance.resize(size);
  planes_.cosine2.resize(size);
  Fit();
}

void ScanWindows::Fit() {
  FitAllWindows(CellPlanes(cells_), static_cast<std::size_t>(cells_.rows()),
                static_cast<std::size_t>(cells_.columns()), planes_);
}

bool ScanWindows::CanEstimateNoise(std::size_t cell) const {
  return std::isfinite(planes_.range_variance[cell]) && planes_.cosine2[cell] > kSteepCosine2;
}

double ScanWindows::NoiseVariance(std::size_t first, std::size_t count,
                                  std::size_t min_windows) const {
  std::vector<double> variances;
  for (std::size_t i = first; i < first + count; ++i) {
    if (CanEstimateNoise(i)) variances.push_back(planes_.range_variance[i]);
  }
  if (variances.size() < min_windows) return 0.0;
  const auto at = variances.begin() + static_cast<std::ptrdiff_t>(
                                          kNoiseQuantile * static_cast<double>(variances.size()));
  std::nth_element(variances.begin(), at, variances.end());
  return std::max(*at, kMinNoise_m * kMinNoise_m);
}

void ScanWindows::SubtractOffsets(std::span<const double> offsets_m) {
  cells_.SubtractOffsets(offsets_m);
  Fit();
}

}  // namespace sextant
