// SPDX-License-Identifier: Apache-2.0
#include "solvers/scan_surfaces.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace sextant {
namespace {

constexpr double kLeastPoints = 12.0;   ///< Of a window.
constexpr double kLeastOfPatch = 3.0;   ///< Points.
constexpr double kNoiseQuantile = 0.3;  ///< Most windows are flat, but not all.
constexpr double kMostVariance = 2.0;   ///< Of a flat window's residuals, in that of the noise.
constexpr double kMostPatchVariance = 3.0;
constexpr double kSteepCosine2 = 0.1;   ///< Windows seen flatter do not tell the noise.
constexpr double kLeastCosine2 = 0.05;  ///< Flatter, more than range noise moves points.
constexpr double kMostTilt_rad = 0.1;   ///< Sigma of a normal that is used.
constexpr std::size_t kLeastWindows = 20;
constexpr double kLeastNoise_m = 1e-4;  ///< No LiDAR is better, and exact data would divide by 0.

// Planes of windows, by the cell in their middle.
struct Windows {
  explicit Windows(std::size_t cells) {
    for (std::vector<double>& m : plane) m.resize(cells);
    for (std::vector<double>& i : inverse) i.resize(cells);
    range_variance.resize(cells);
    cosine2.resize(cells);
  }

  std::array<std::vector<double>, 3> plane;    ///< m of m . p = 1.
  std::array<std::vector<double>, 6> inverse;  ///< Of sum p p^T.
  std::vector<double> range_variance;          ///< Infinite where there is no plane.
  std::vector<double> cosine2;                 ///< Squared, of the angle of incidence.
};

// The sums of cells as structure of arrays, with a border of a cell that closes the circle and is
// empty above and below.
class CellPlanes {
 public:
  explicit CellPlanes(const ScanCells& cells)
      : stride_(static_cast<std::size_t>(cells.columns()) + 2 + kLanes) {
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

  // Sums over the 3 x 3 cells round each of eight cells of a row.
  SEXTANT_INLINE Lanes Window(std::size_t k, std::size_t row, std::size_t column) const {
    Lanes sum = AllLanes(0.0);
    for (std::size_t r = 0; r < 3; ++r) {
      const double* at = of_[k].data() + (row + r) * stride_ + column;
      sum += (LoadLanes(at) + LoadLanes(at + 1)) + LoadLanes(at + 2);
    }
    return sum;
  }

 private:
  std::size_t stride_;
  std::array<std::vector<double>, CellSums::kSize> of_;
};

// Eight windows.
struct WindowFit {
  std::array<Lanes, 3> plane;
  std::array<Lanes, 6> inverse;
  Lanes range_variance;
  Lanes cosine2;
};

SEXTANT_INLINE WindowFit FitWindows(const CellPlanes& cells, std::size_t row, std::size_t column) {
  const Lanes count = cells.Window(CellSums::kCount, row, column);
  std::array<Lanes, 3> s;
  std::array<Lanes, 6> q;
  for (std::size_t k = 0; k < 3; ++k) s[k] = cells.Window(CellSums::kFirst + k, row, column);
  for (std::size_t k = 0; k < 6; ++k) q[k] = cells.Window(CellSums::kSecond + k, row, column);
  WindowFit fit;
  std::array<Lanes, 6>& i = fit.inverse;  // The adjugate first.
  i[0] = q[3] * q[5] - q[4] * q[4];
  i[1] = q[2] * q[4] - q[1] * q[5];
  i[2] = q[1] * q[4] - q[2] * q[3];
  i[3] = q[0] * q[5] - q[2] * q[2];
  i[4] = q[1] * q[2] - q[0] * q[4];
  i[5] = q[0] * q[3] - q[1] * q[1];
  const Lanes determinant = q[0] * i[0] + q[1] * i[1] + q[2] * i[2];
  const LaneMask usable = (determinant > 0.0) & (count >= kLeastPoints);
  const Lanes scale = 1.0 / (usable ? determinant : AllLanes(1.0));
  for (Lanes& element : i) element *= scale;
  std::array<Lanes, 3>& m = fit.plane;
  m[0] = i[0] * s[0] + i[1] * s[1] + i[2] * s[2];
  m[1] = i[1] * s[0] + i[3] * s[1] + i[4] * s[2];
  m[2] = i[2] * s[0] + i[4] * s[1] + i[5] * s[2];
  const Lanes m_s = m[0] * s[0] + m[1] * s[1] + m[2] * s[2];
  const Lanes m_m = m[0] * m[0] + m[1] * m[1] + m[2] * m[2];
  const Lanes s_s = s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
  const LaneMask has_plane = usable & (m_m > 0.0) & (s_s > 0.0);
  const Lanes squares = Max(count - m_s, AllLanes(0.0));
  fit.cosine2 = Max(m_s * m_s / (has_plane ? m_m * s_s : AllLanes(1.0)), AllLanes(kLeastCosine2));
  const Lanes variance =
      squares / ((has_plane ? (count - 3.0) * m_m : AllLanes(1.0)) * fit.cosine2);
  fit.range_variance = has_plane ? variance : AllLanes(HUGE_VAL);
  return fit;
}

// Cells beyond a row's end are cut off by the next row's, or by the vectors' last kLanes.
SEXTANT_MULTIVERSION
void FitAllWindows(const CellPlanes& cells, std::size_t rows, std::size_t columns,
                   Windows& windows) {
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; column += kLanes) {
      const WindowFit fit = FitWindows(cells, row, column);
      const std::size_t at = row * columns + column;
      for (std::size_t k = 0; k < 3; ++k) StoreLanes(fit.plane[k], windows.plane[k].data() + at);
      for (std::size_t k = 0; k < 6; ++k) {
        StoreLanes(fit.inverse[k], windows.inverse[k].data() + at);
      }
      StoreLanes(fit.range_variance, windows.range_variance.data() + at);
      StoreLanes(fit.cosine2, windows.cosine2.data() + at);
    }
  }
}

// Of the ranges; 0 where the scan shows no surfaces.
double NoiseVariance(const Windows& windows, std::size_t cells) {
  std::vector<double> variances;
  for (std::size_t i = 0; i < cells; ++i) {
    const bool tells =
        std::isfinite(windows.range_variance[i]) && windows.cosine2[i] > kSteepCosine2;
    if (tells) variances.push_back(windows.range_variance[i]);
  }
  if (variances.size() < kLeastWindows) return 0.0;
  const auto at = variances.begin() + static_cast<std::ptrdiff_t>(
                                          kNoiseQuantile * static_cast<double>(variances.size()));
  std::nth_element(variances.begin(), at, variances.end());
  return std::max(*at, kLeastNoise_m * kLeastNoise_m);
}

// The number of the window whose plane cell (row, column) takes.
std::optional<std::size_t> BestWindow(const Windows& windows, const ScanCells& cells, int row,
                                      int column, double most_variance) {
  const auto at = [&](int r, int c) { return static_cast<std::size_t>(r * cells.columns() + c); };
  const std::size_t own = at(row, column);
  if (windows.range_variance[own] < most_variance) return own;
  std::optional<std::size_t> best;
  double least = most_variance;
  for (int r = std::max(row - 1, 0); r <= std::min(row + 1, cells.rows() - 1); ++r) {
    for (int c = -1; c <= 1; ++c) {
      const std::size_t other = at(r, (column + c + cells.columns()) % cells.columns());
      if (!(windows.range_variance[other] < least)) continue;
      least = windows.range_variance[other];
      best = other;
    }
  }
  return best;
}

ScanPlane PlaneOf(const Windows& windows, std::size_t i, double noise_variance) {
  const Eigen::Vector3d m(windows.plane[0][i], windows.plane[1][i], windows.plane[2][i]);
  ScanPlane plane;
  plane.distance = 1.0 / m.norm();
  for (std::size_t k = 0; k < 3; ++k) plane.normal[k] = windows.plane[k][i] * plane.distance;
  plane.variance_m2 = noise_variance * windows.cosine2[i];
  for (std::size_t k = 0; k < 6; ++k) plane.inverse_moments[k] = windows.inverse[k][i];
  return plane;
}

// A single ring leaves a plane free to turn about it.
bool IsTiltKnown(const ScanPlane& plane) {
  const std::array<double, 6>& i = plane.inverse_moments;
  return plane.variance_m2 * (i[0] + i[3] + i[5]) < kMostTilt_rad * kMostTilt_rad;
}

double AlongNormal(const ScanPlane& plane, const CellSums& sums) {
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

ScanSurfaces::ScanSurfaces(std::span<const Eigen::Vector3d> points, double cell_rad)
    : cells_(points, cell_rad) {
  ChoosePlanes();
  FillUp();
}

void ScanSurfaces::ChoosePlanes() {
  const std::size_t count = cells_.sums().size();
  planes_.resize(count + 1);
  std::vector<bool> is_known(count, false);
  Windows windows(count + kLanes);
  FitAllWindows(CellPlanes(cells_), static_cast<std::size_t>(cells_.rows()),
                static_cast<std::size_t>(cells_.columns()), windows);
  const double noise_variance = NoiseVariance(windows, count);
  range_sigma_m_ = std::sqrt(noise_variance);
  for (std::size_t cell = 0; cell < count; ++cell) {
    if (cells_.sums()[cell].of[CellSums::kCount] == 0.0) continue;
    const int row = static_cast<int>(cell) / cells_.columns();
    const int column = static_cast<int>(cell) % cells_.columns();
    const std::optional<std::size_t> window =
        BestWindow(windows, cells_, row, column, kMostVariance * noise_variance);
    if (!window) continue;
    const ScanPlane plane = PlaneOf(windows, *window, noise_variance);
    if (!IsTiltKnown(plane)) continue;
    planes_[cell] = plane;
    AddPatch(cell);
  }
}

void ScanSurfaces::AddPatch(std::size_t cell) {
  const CellSums& sums = cells_.sums()[cell];
  const ScanPlane& plane = planes_[cell];
  const double count = sums.of[CellSums::kCount];
  if (count < kLeastOfPatch) return;
  if (AlongNormal(plane, sums) > kMostPatchVariance * plane.variance_m2) return;
  for (std::size_t k = 0; k < 3; ++k) {
    patches_.middle[k].push_back(sums.of[CellSums::kFirst + k] / count);
    patches_.normal[k].push_back(plane.normal[k]);
  }
  patches_.inverse_count.push_back(1.0 / count);
  ++patch_count_;
}

void ScanSurfaces::FillUp() {
  const std::size_t padded = (patch_count_ + kLanes - 1) / kLanes * kLanes;
  for (std::size_t k = 0; k < 3; ++k) {
    patches_.middle[k].resize(padded, 0.0);
    patches_.normal[k].resize(padded, 0.0);
  }
  patches_.inverse_count.resize(padded, 1.0);
}

}  // namespace sextant
