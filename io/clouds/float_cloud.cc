// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/float_cloud.h"

#include <fmt/core.h>

#include "base/text/path_text.h"
#include "io/clouds/cloud_builder.h"
#include "io/clouds/scalar_type.h"
#include "io/text/number_text.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

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

}  // namespace

Expected<PointCloud> ReadFloatCloud(const std::filesystem::path& path) {
  return ReadWith(path, ParseFloatCloud);
}

Expected<PointCloud> ParseFloatCloud(std::string_view bytes, const std::string& file) {
  const auto fits = [bytes](std::size_t numbers) {
    return !bytes.empty() && bytes.size() % (sizeof(float) * numbers) == 0;
  };
  const bool has_rings = fits(kNuScenesNumbers) && HasRings(bytes);
  if (!has_rings && !fits(kKittiNumbers)) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}: byte {}: the file ends within a point; expected x, y, z, "
                                 "intensity as float32, 16 bytes per point (KITTI), or with the "
                                 "ring, 20 bytes (nuScenes)",
                                 PathText(file), bytes.size()));
  }
  const std::size_t numbers = has_rings ? kNuScenesNumbers : kKittiNumbers;
  const std::size_t points = bytes.size() / (sizeof(float) * numbers);
  CloudBuilder builder(UnnamedColumns(numbers, has_rings), points);
  for (std::size_t i = 0; i < points; ++i) {
    SEXTANT_RETURN_IF_ERROR(
        builder.Add([&](std::size_t column) { return FloatAt(bytes, numbers * i + column); }));
  }
  return std::move(builder).Finish();
}

}  // namespace sextant
