// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/float_cloud.h"

#include <fmt/core.h>

#include <cmath>
#include <optional>
#include <vector>

#include "base/text/path_text.h"
#include "io/clouds/cloud_builder.h"
#include "io/clouds/scalar_type.h"
#include "io/text/number_text.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

constexpr std::size_t kMinNumbers = 3;
constexpr std::size_t kMaxNumbers = 8;
constexpr std::size_t kKittiNumbers = 4;
constexpr std::size_t kNuScenesNumbers = 5;

double FloatAt(std::string_view bytes, std::size_t index) {
  return LoadScalar(bytes.data() + sizeof(float) * index, ScalarType::kFloat32, false);
}

// Whether every fifth number is a ring. Where all numbers look like rings, nothing is known.
bool HasRings(std::string_view bytes) {
  bool all_alike = true;
  for (std::size_t i = 0; i < bytes.size() / sizeof(float); ++i) {
    const bool is_ring = IsRingNumber(FloatAt(bytes, i));
    if (i % kNuScenesNumbers == kNuScenesNumbers - 1 && !is_ring) return false;
    all_alike = all_alike && is_ring;
  }
  return !all_alike;
}

// Signed logarithms, so that ranges do not hide that a column has small numbers.
double Compressed(double value) {
  constexpr double kFinest = 1e-3;
  if (!std::isfinite(value)) return 0.0;
  return std::copysign(std::log1p(std::abs(value) / kFinest), value);
}

// The share of the numbers' variance that is between the columns of a table with `columns`
// columns: nearly none where numbers of several kinds share each column.
double ColumnShare(std::string_view bytes, std::size_t columns) {
  std::vector<double> sums(columns, 0.0);
  double sum = 0.0;
  double squares = 0.0;
  const std::size_t count = bytes.size() / sizeof(float);
  for (std::size_t i = 0; i < count; ++i) {
    const double value = Compressed(FloatAt(bytes, i));
    sums[i % columns] += value;
    sum += value;
    squares += value * value;
  }
  const auto n = static_cast<double>(count);
  double between = 0.0;
  for (const double of_column : sums) between += of_column * of_column;
  between = (between * static_cast<double>(columns) - sum * sum) / n;
  const double total = squares - sum * sum / n;
  return total > 0.0 ? between / total : 0.0;
}

// The count of numbers a point for which the columns differ most; KITTI's four unless another is
// clear. None where the size fits neither.
std::optional<std::size_t> NumbersAPoint(std::string_view bytes) {
  constexpr double kClear = 0.05;
  constexpr std::size_t kMinPoints = 100;
  const std::size_t count = bytes.size() / sizeof(float);
  if (count == 0 || bytes.size() % sizeof(float) != 0) return std::nullopt;
  if (count % kNuScenesNumbers == 0 && HasRings(bytes)) return kNuScenesNumbers;
  std::optional<std::size_t> best;
  double best_share = 0.0;
  if (count % kKittiNumbers == 0) {
    best = kKittiNumbers;
    best_share = ColumnShare(bytes, kKittiNumbers);
  }
  for (std::size_t numbers = kMinNumbers; numbers <= kMaxNumbers; ++numbers) {
    if (count % numbers != 0 || count / numbers < kMinPoints) continue;
    const double share = ColumnShare(bytes, numbers);
    if (share < best_share + kClear) continue;
    best = numbers;
    best_share = share;
  }
  return best;
}

// Whether many numbers are of no scan in metres, as those of integers or float64 read as float32.
bool AreOtherNumbers(std::string_view bytes) {
  constexpr double kMaxShare = 0.05;
  constexpr double kLargest = 1e7;
  constexpr double kSmallest = 1e-12;
  const std::size_t count = bytes.size() / sizeof(float);
  std::size_t odd = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double size = std::abs(FloatAt(bytes, i));
    odd += size > kLargest || (size > 0.0 && size < kSmallest) ? 1U : 0U;
  }
  return static_cast<double>(odd) > kMaxShare * static_cast<double>(count);
}

}  // namespace

Expected<PointCloud> ReadFloatCloud(const std::filesystem::path& path) {
  return ReadWith(path, ParseFloatCloud);
}

Expected<PointCloud> ParseFloatCloud(std::string_view bytes, const std::string& file) {
  const std::optional<std::size_t> numbers = NumbersAPoint(bytes);
  if (!numbers) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}: byte {}: the file ends within a point; expected x, y, z, "
                                 "intensity as float32, 16 bytes per point (KITTI), or with the "
                                 "ring, 20 bytes (nuScenes)",
                                 PathText(file), bytes.size()));
  }
  if (AreOtherNumbers(bytes)) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}: many of the numbers are far too large or small for a scan in "
                                 "metres; expected float32 (KITTI, nuScenes), neither float64 nor "
                                 "integers",
                                 PathText(file)));
  }
  const std::size_t points = bytes.size() / (sizeof(float) * *numbers);
  const bool has_rings = *numbers == kNuScenesNumbers && HasRings(bytes);
  CloudBuilder builder(UnnamedColumns(*numbers, has_rings), points);
  for (std::size_t i = 0; i < points; ++i) {
    SEXTANT_RETURN_IF_ERROR(
        builder.Add([&](std::size_t column) { return FloatAt(bytes, *numbers * i + column); }));
  }
  return std::move(builder).Finish();
}

}  // namespace sextant
