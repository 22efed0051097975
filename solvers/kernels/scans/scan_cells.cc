// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/scans/scan_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace sextant {
namespace {

using Points = std::span<const Eigen::Vector3d>;

constexpr int kMinRings = 4;
constexpr int kMinColumns = 8;
constexpr double kMinRingShare = 0.02;  ///< Bins with less than this of the fullest are gaps.
constexpr int kMinGap = 2;              ///< Bins between two rings.
constexpr double kMinRow = 0.75;        ///< Height of a row of whole rings, in cells.

// Eight points from `first` on; the last one is repeated where there are fewer.
SEXTANT_INLINE std::array<Vec8d, 3> LoadPoints(Points points, std::size_t first,
                                               const std::array<std::size_t, 3>& axes) {
  std::array<Vec8d, 3> loaded;
  for (std::size_t i = 0; i < kSimdWidth; ++i) {
    const Eigen::Vector3d& point = points[std::min(first + i, points.size() - 1)];
    for (std::size_t k = 0; k < 3; ++k) loaded[k][i] = point.data()[axes[k]];
  }
  return loaded;
}

// The middles of the rings in the histogram of slopes [bins]; empty where there are no rings or one
// is wider than `max_width` bins.
struct Rings {
  std::vector<double> middles;
};

Rings FindRings(std::span<const int> histogram, double max_width) {
  const double min_count = kMinRingShare * *std::ranges::max_element(histogram);
  Rings rings;
  int begin = -1;
  int last = -1;
  const auto close = [&] {
    if (begin >= 0) rings.middles.push_back(0.5 * (begin + last));
    return begin < 0 || last - begin <= max_width;
  };
  for (int bin = 0; bin < static_cast<int>(histogram.size()); ++bin) {
    if (histogram[static_cast<std::size_t>(bin)] <= min_count) continue;
    if (begin < 0 || bin - last > kMinGap) {
      if (!close()) return {};
      begin = bin;
    }
    last = bin;
  }
  if (!close() || rings.middles.size() < kMinRings) return {};
  return rings;
}

// The bins at which rows begin, from the second row on.
std::vector<int> RowStarts(const Rings& rings, double cell_bins, int bins) {
  std::vector<int> starts;
  if (rings.middles.empty()) {
    for (double start = cell_bins; start < bins; start += cell_bins) {
      starts.push_back(static_cast<int>(start));
    }
    return starts;
  }
  double lowest = rings.middles.front();
  for (std::size_t i = 1; i < rings.middles.size(); ++i) {
    if (rings.middles[i] - lowest < kMinRow * cell_bins) continue;
    starts.push_back(static_cast<int>(0.5 * (rings.middles[i - 1] + rings.middles[i])) + 1);
    lowest = rings.middles[i];
  }
  return starts;
}

}  // namespace

// Defined before its first use, as clang requires for functions with several versions.
SEXTANT_MULTIVERSION
void ScanCells::FindBearings(Points points, double* slopes, std::int32_t* columns) const {
  for (std::size_t i = 0; i < points.size(); i += kSimdWidth) {
    const std::array<Vec8d, 3> xyz = LoadPoints(points, i, axes_);
    StoreVec(SlopesOf(xyz[0], xyz[1], xyz[2]), slopes + i);
    ColumnsOf(xyz[0], xyz[1], columns + i);
  }
}

ScanCells::ScanCells(Points points, double cell_rad) : cell_rad_(cell_rad) {
  ChooseAxes(points);
  columns_ = std::max(kMinColumns, static_cast<int>(2.0 * std::numbers::pi / cell_rad));
  std::vector<double> slopes(points.size() + kSimdWidth);
  std::vector<std::int32_t> columns(points.size() + kSimdWidth);
  FindBearings(points, slopes.data(), columns.data());
  slopes.resize(points.size());
  ChooseRows(slopes, cell_rad);
  sums_.resize(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(columns_));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::int32_t row = row_of_bin_[static_cast<std::size_t>(BinOf(slopes[i]))];
    if (row < 0) continue;
    const double x = points[i].x();
    const double y = points[i].y();
    const double z = points[i].z();
    CellSums& sums = sums_[static_cast<std::size_t>(row * columns_ + columns[i])];
    const std::array<double, CellSums::kSize> added = {1.0,   x,     y,     z,     x * x,
                                                       x * y, x * z, y * y, y * z, z * z};
    for (std::size_t k = 0; k < added.size(); ++k) sums.of[k] += added[k];
  }
}

// Decides by a sample of the points.
void ScanCells::ChooseAxes(Points points) {
  Eigen::Array3d squares = Eigen::Array3d::Zero();
  const std::size_t step = std::max<std::size_t>(1, points.size() / 1000);
  for (std::size_t i = 0; i < points.size(); i += step) {
    const double square = points[i].squaredNorm();
    if (square > 0.0) squares += points[i].array().square() / square;
  }
  // The margin keeps z where the axes are about equal.
  Eigen::Index chosen = 2;
  for (const Eigen::Index axis : {1, 0}) {
    if (squares[axis] < 0.8 * squares[chosen]) chosen = axis;
  }
  const auto polar = static_cast<std::size_t>(chosen);
  axes_ = {(polar + 1) % 3, (polar + 2) % 3, polar};
}

void ScanCells::ChooseRows(std::span<const double> slopes, double cell_rad) {
  const auto [lowest, highest] = std::ranges::minmax(slopes);
  const double margin = 0.5 * std::tan(cell_rad);
  first_slope_ = lowest - margin;
  bins_per_slope_ = kBins / (highest - lowest + 2.0 * margin);
  std::vector<int> histogram(row_of_bin_.size());
  for (const double slope : slopes) {
    if (std::abs(slope) < kSteepest) ++histogram[static_cast<std::size_t>(BinOf(slope))];
  }
  const double cell_bins = cell_rad * bins_per_slope_;
  const std::vector<int> starts = RowStarts(FindRings(histogram, cell_bins), cell_bins, kBins);
  rows_ = static_cast<int>(starts.size()) + 1;
  std::int16_t row = 0;
  for (int bin = 0; bin < static_cast<int>(row_of_bin_.size()); ++bin) {
    while (row + 1 < rows_ && bin >= starts[static_cast<std::size_t>(row)]) ++row;
    row_of_bin_[static_cast<std::size_t>(bin)] = row;
  }
  row_of_bin_.front() = -1;
  row_of_bin_.back() = -1;
}

double ScanCells::SlopeOf(int row) const {
  constexpr std::array<std::size_t, 3> kSquares = {CellSums::kSecond, CellSums::kSecond + 3,
                                                   CellSums::kSecond + 5};
  double height = 0.0;
  double up2 = 0.0;
  double level2 = 0.0;
  for (int column = 0; column < columns_; ++column) {
    const CellSums& sums = sums_[static_cast<std::size_t>(row * columns_ + column)];
    height += sums.of[CellSums::kFirst + axes_[2]];
    up2 += sums.of[kSquares[axes_[2]]];
    level2 += sums.of[kSquares[axes_[0]]] + sums.of[kSquares[axes_[1]]];
  }
  return level2 > 0.0 ? std::copysign(std::sqrt(up2 / level2), height) : 0.0;
}

void ScanCells::SubtractOffsets(std::span<const double> offsets_m) {
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    std::array<double, CellSums::kSize>& of = sums_[i].of;
    if (of[CellSums::kCount] == 0.0) continue;
    const double squares =
        of[CellSums::kSecond] + of[CellSums::kSecond + 3] + of[CellSums::kSecond + 5];
    const double offset_m = offsets_m[i / static_cast<std::size_t>(columns_)];
    const double scale = 1.0 - offset_m * std::sqrt(of[CellSums::kCount] / squares);
    for (std::size_t k = CellSums::kFirst; k < CellSums::kSecond; ++k) of[k] *= scale;
    for (std::size_t k = CellSums::kSecond; k < CellSums::kSize; ++k) of[k] *= scale * scale;
  }
}

}  // namespace sextant
