// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/las_cloud.h"

#include <fmt/core.h>

#include <array>
#include <cstdint>

#include "base/text/path_text.h"
#include "io/clouds/cloud_builder.h"
#include "io/clouds/scalar_type.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

// Bytes of the public header block, as the ASPRS specification lists them.
constexpr std::size_t kMinorVersionAt = 25;
constexpr std::size_t kPointsBeginAt = 96;
constexpr std::size_t kFormatAt = 104;
constexpr std::size_t kRecordSizeAt = 105;
constexpr std::size_t kCountAt = 107;
constexpr std::size_t kScaleAt = 131;
constexpr std::size_t kOffsetAt = 155;
constexpr std::size_t kLongCountAt = 247;
constexpr std::size_t kHeaderBytes = 227;
constexpr std::size_t kLongHeaderBytes = 375;  // Version 1.4.
constexpr std::size_t kIntensityInRecord = 12;
// The smallest record of each point format, and where its time is; 0 for none.
struct LasFormat {
  std::size_t bytes;
  std::size_t time_at;
};
constexpr std::array<LasFormat, 11> kFormats = {{{20, 0},
                                                 {28, 20},
                                                 {26, 0},
                                                 {34, 20},
                                                 {57, 20},
                                                 {63, 20},
                                                 {30, 22},
                                                 {36, 22},
                                                 {38, 22},
                                                 {59, 22},
                                                 {67, 22}}};

tl::unexpected<Error> RefuseLas(const std::string& file, std::size_t byte, std::string_view what) {
  return MakeError(ErrorCode::kParse, fmt::format("{}: byte {}: {}", PathText(file), byte, what));
}

struct LasHeader {
  LasFormat format{};
  std::size_t begin = 0;
  std::size_t record = 0;
  std::size_t points = 0;
};

std::size_t WholeAt(std::string_view bytes, std::size_t at, ScalarType type) {
  return static_cast<std::size_t>(LoadScalar(bytes.data() + at, type, false));
}

Expected<LasHeader> ReadLasHeader(std::string_view bytes, const std::string& file) {
  if (bytes.size() < kHeaderBytes) {
    return RefuseLas(file, bytes.size(), "the file ends within the header of a LAS file");
  }
  const std::size_t format = WholeAt(bytes, kFormatAt, ScalarType::kUint8);
  constexpr std::size_t kCompressed = 128;
  if (format >= kCompressed) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}: the points are compressed (LAZ), which is not read; convert "
                                 "them with 'pdal translate IN.laz OUT.las' or 'las2las -i IN.laz "
                                 "-o OUT.las'",
                                 PathText(file)));
  }
  if (format >= kFormats.size()) {
    return RefuseLas(file, kFormatAt,
                     fmt::format("expected a point format from 0 to 10, got {}", format));
  }
  LasHeader header{.format = kFormats[format],
                   .begin = WholeAt(bytes, kPointsBeginAt, ScalarType::kUint32),
                   .record = WholeAt(bytes, kRecordSizeAt, ScalarType::kUint16),
                   .points = WholeAt(bytes, kCountAt, ScalarType::kUint32)};
  const bool has_long_count =
      WholeAt(bytes, kMinorVersionAt, ScalarType::kUint8) >= 4 && bytes.size() >= kLongHeaderBytes;
  if (has_long_count && header.points == 0) {
    // In halves: a double does not have all whole numbers of 64 bits.
    header.points = (WholeAt(bytes, kLongCountAt + 4, ScalarType::kUint32) << 32U) +
                    WholeAt(bytes, kLongCountAt, ScalarType::kUint32);
  }
  if (header.record < header.format.bytes) {
    return RefuseLas(file, kRecordSizeAt,
                     fmt::format("points of format {} have {} bytes, the header states {}", format,
                                 header.format.bytes, header.record));
  }
  const std::size_t room = header.begin > bytes.size() ? 0 : bytes.size() - header.begin;
  if (header.begin < kHeaderBytes || header.points > room / header.record || header.points == 0) {
    return RefuseLas(file, bytes.size(),
                     fmt::format("the header states {} points of {} bytes from byte {}; the file "
                                 "has room for {}",
                                 header.points, header.record, header.begin, room / header.record));
  }
  return header;
}

}  // namespace

Expected<PointCloud> ReadLasCloud(const std::filesystem::path& path) {
  return ReadWith(path, ParseLasCloud);
}

Expected<PointCloud> ParseLasCloud(std::string_view bytes, const std::string& file) {
  SEXTANT_ASSIGN_OR_RETURN(const LasHeader header, ReadLasHeader(bytes, file));
  CloudColumns columns{.x = 0, .y = 1, .z = 2, .intensity = 3};
  if (header.format.time_at > 0) columns.time = 4;
  CloudBuilder builder(columns, header.points);
  for (std::size_t i = 0; i < header.points; ++i) {
    const char* const record = bytes.data() + header.begin + i * header.record;
    const auto coordinate = [&](std::size_t axis) {
      const std::size_t at = axis * sizeof(double);
      return LoadScalar(record + axis * sizeof(std::int32_t), ScalarType::kInt32, false) *
                 LoadScalar(bytes.data() + kScaleAt + at, ScalarType::kFloat64, false) +
             LoadScalar(bytes.data() + kOffsetAt + at, ScalarType::kFloat64, false);
    };
    const Expected<void> added = builder.Add([&](std::size_t column) {
      if (column < 3) return coordinate(column);
      return column == 3 ? LoadScalar(record + kIntensityInRecord, ScalarType::kUint16, false)
                         : LoadScalar(record + header.format.time_at, ScalarType::kFloat64, false);
    });
    if (!added) {
      return MakeError(added.error().code,
                       fmt::format("{}: point {}: {}", PathText(file), i, added.error().message));
    }
  }
  return std::move(builder).Finish();
}

}  // namespace sextant
