// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/scans/scan_surfaces.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace sextant {
namespace {

constexpr double kMinPatchPoints = 3.0;
constexpr double kMaxVariance = 2.0;  ///< Residual variance of a flat window, in noise variances.
constexpr double kMaxPatchVariance = 3.0;
constexpr double kMaxTilt_rad = 0.1;  ///< Maximum sigma of the normal of a plane that is used.
constexpr std::size_t kMinWindows = 20;

// The window whose plane cell (row, column) takes.
std::optional<std::size_t> BestWindow(const ScanWindows::Planes& windows, const ScanCells& cells,
                                      int row, int column, double max_variance) {
  const auto at = [&](int r, int c) { return static_cast<std::size_t>(r * cells.columns() + c); };
  const std::size_t own = at(row, column);
  if (windows.range_variance[own] < max_variance) return own;
  std::optional<std::size_t> best;
  double lowest = max_variance;
  for (int r = std::max(row - 1, 0); r <= std::min(row + 1, cells.rows() - 1); ++r) {
    for (int c = -1; c <= 1; ++c) {
      const std::size_t other = at(r, (column + c + cells.columns()) % cells.columns());
      if (!(windows.range_variance[other] < lowest)) continue;
      lowest = windows.range_variance[other];
      best = other;
    }
  }
  return best;
}

ScanPlane PlaneOf(const ScanWindows::Planes& windows, std::size_t i, double noise_variance) {
  const Eigen::Vector3d m(windows.plane[0][i], windows.plane[1][i], windows.plane[2][i]);
  ScanPlane plane;
  plane.distance = 1.0 / m.norm();
  for (std::size_t k = 0; k < 3; ++k) plane.normal[k] = windows.plane[k][i] * plane.distance;
  plane.variance_m2 = noise_variance * windows.cosine2[i];
  for (std::size_t k = 0; k < 6; ++k) plane.inverse_moments[k] = windows.inverse[k][i];
  return plane;
}

// The points of a single ring do not determine the tilt of a plane about it.
bool IsTiltKnown(const ScanPlane& plane) {
  const std::array<double, 6>& i = plane.inverse_moments;
  return plane.variance_m2 * (i[0] + i[3] + i[5]) < kMaxTilt_rad * kMaxTilt_rad;
}

// Variance of the points of a cell along the normal of the plane.
double VarianceAlongNormal(const ScanPlane& plane, const CellSums& sums) {
  const std::array<double, 3>& n = plane.normal;
  const double* q = sums.of.data() + CellSums::kSecond;
  const double count = sums.of[CellSums::kCount];
  const double* s = sums.of.data() + CellSums::kFirst;
  const double squares = n[0] * n[0] * q[0] + n[1] * n[1] * q[3] + n[2] * n[2] * q[5] +
                         2.0 * (n[0] * n[1] * q[1] + n[0] * n[2] * q[2] + n[1] * n[2] * q[4]);
  const double mean = (n[0] * s[0] + n[1] * s[1] + n[2] * s[2]) / count;
  return squares / count - mean * mean;
}

}  // namespace

ScanSurfaces::ScanSurfaces(const ScanWindows& windows) : cells_(windows.cells()) {
  ChoosePlanes(windows);
  Pad();
}

void ScanSurfaces::ChoosePlanes(const ScanWindows& windows) {
  const std::size_t count = cells_.sums().size();
  planes_.resize(count + 1);
  const double noise_variance = windows.NoiseVariance(0, count, kMinWindows);
  range_sigma_m_ = std::sqrt(noise_variance);
  for (std::size_t cell = 0; cell < count; ++cell) {
    if (cells_.sums()[cell].of[CellSums::kCount] == 0.0) continue;
    const int row = static_cast<int>(cell) / cells_.columns();
    const int column = static_cast<int>(cell) % cells_.columns();
    const std::optional<std::size_t> window =
        BestWindow(windows.planes(), cells_, row, column, kMaxVariance * noise_variance);
    if (!window) continue;
    const ScanPlane plane = PlaneOf(windows.planes(), *window, noise_variance);
    if (!IsTiltKnown(plane)) continue;
    planes_[cell] = plane;
    AddPatch(cell);
  }
}

void ScanSurfaces::AddPatch(std::size_t cell) {
  const CellSums& sums = cells_.sums()[cell];
  const ScanPlane& plane = planes_[cell];
  const double count = sums.of[CellSums::kCount];
  if (count < kMinPatchPoints) return;
  if (VarianceAlongNormal(plane, sums) > kMaxPatchVariance * plane.variance_m2) return;
  for (std::size_t k = 0; k < 3; ++k) {
    patches_.middle[k].push_back(sums.of[CellSums::kFirst + k] / count);
    patches_.normal[k].push_back(plane.normal[k]);
  }
  patches_.inverse_count.push_back(1.0 / count);
  ++patch_count_;
}

void ScanSurfaces::Pad() {
  const std::size_t padded = (patch_count_ + kSimdWidth - 1) / kSimdWidth * kSimdWidth;
  for (std::size_t k = 0; k < 3; ++k) {
    patches_.middle[k].resize(padded, 0.0);
    patches_.normal[k].resize(padded, 0.0);
  }
  patches_.inverse_count.resize(padded, 1.0);
}

}  // namespace sextant
