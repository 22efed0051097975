// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <lzf.h>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "base/text/path_text.h"
#include "io/clouds/cloud_builder.h"
#include "io/clouds/pcd_file.h"
#include "io/clouds/scalar_type.h"
#include "io/text/line_reader.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

tl::unexpected<Error> Refuse(const std::string& file, int line, const std::string& message) {
  return MakeError(ErrorCode::kParse,
                   fmt::format("{}: {}", ToString(Place{.file = file, .line = line}), message));
}

// The fields that a PointCloud has, as indices into header.fields; those of several values a point
// and padding have no name.
Expected<CloudColumns> FindFields(const PcdHeader& header, const std::string& file) {
  std::vector<NamedColumn> columns;
  for (const PcdField& field : header.fields) {
    columns.push_back({field.count == 1 ? field.name : "_", field.type != 'F'});
  }
  return AtPlace(FindCloudColumns(columns), {.file = file, .name = "FIELDS"});
}

// A number of an ascii file; "nan" and "inf" are NaN, a ray without a return. A value of a 4-byte
// field is rounded to a float, so that ascii and binary files of one scan give the same bits.
double AsciiValue(LineReader& in, const PcdField& field) {
  if (!in.ok()) return 0.0;
  const std::string_view text = in.Field(field.position);
  double value = 0.0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size()) {
    return in.Real(field.position, field.name);
  }
  if (!std::isfinite(value)) return std::numeric_limits<double>::quiet_NaN();
  return field.type == 'F' && field.size == 4 ? ToFloat(value) : value;
}

Expected<PointCloud> ReadAscii(const PcdHeader& header, const CloudColumns& columns,
                               std::string_view text, const std::string& file) {
  const std::size_t shortest_point = 2 * header.point_values;
  const std::size_t max_points = (text.size() - header.body + 1) / shortest_point;
  if (header.points > max_points) {
    return Refuse(file, 0,
                  fmt::format("the header states {} points, but the file has room for at most {}",
                              header.points, max_points));
  }
  LineReader in(file, text);
  while (in.Next() && in.Field(0) != "DATA") {
  }
  CloudBuilder builder(columns, header.points);
  const std::string row = fmt::format("the {} values of a point", header.point_values);
  for (std::size_t i = 0; i < header.points && in.ok(); ++i) {
    if (!in.Require(row) || !in.HasFields(header.point_values, row)) break;
    const Expected<void> added =
        builder.Add([&](std::size_t column) { return AsciiValue(in, header.fields[column]); });
    if (!added) in.Fail(added.error().code, added.error().message);
  }
  if (in.ok() && in.Next()) {
    in.Fail(ErrorCode::kParse,
            fmt::format("expected the end of the file after the {} points of the header",
                        header.points));
  }
  if (!in.ok()) return in.TakeError();
  return std::move(builder).Take();
}

// Data in memory: point after point, or field after field.
Expected<PointCloud> ReadValues(const PcdHeader& header, const CloudColumns& columns,
                                std::string_view data, bool by_field, const std::string& file) {
  CloudBuilder builder(columns, header.points);
  for (std::size_t i = 0; i < header.points; ++i) {
    const Expected<void> added = builder.Add([&](std::size_t column) {
      const PcdField& field = header.fields[column];
      const std::size_t at = by_field ? field.offset * header.points + i * field.size
                                      : i * header.point_bytes + field.offset;
      return LoadScalar(data.data() + at, field.scalar_type(), false);
    });
    if (!added) {
      return MakeError(added.error().code,
                       fmt::format("{}: point {}: {}", PathText(file), i, added.error().message));
    }
  }
  return std::move(builder).Take();
}

Expected<PointCloud> ReadBinary(const PcdHeader& header, const CloudColumns& columns,
                                std::string_view text, const std::string& file) {
  // The Point Cloud Library pads its files to whole pages.
  constexpr std::size_t kMaxPadding = std::size_t{1} << 16;
  const std::string_view data = text.substr(header.body);
  const std::size_t expected = header.points * header.point_bytes;
  if (data.size() < expected || data.size() > expected + kMaxPadding) {
    return Refuse(file, 0,
                  fmt::format("the header states {} points of {} bytes, {} bytes in all; the file "
                              "has {} after its header",
                              header.points, header.point_bytes, expected, data.size()));
  }
  return ReadValues(header, columns, data, false, file);
}

// Runs of one value compress to less than a hundredth, so a small file could demand gigabytes: the
// values, and the cloud that they become, may take 64 times as much as the file.
Expected<void> CheckExpansion(const PcdHeader& header, std::size_t unpacked, std::size_t packed,
                              const std::string& file) {
  constexpr std::size_t kUnchecked = std::size_t{64} << 20;
  constexpr std::size_t kMaxRatio = 64;
  const std::size_t memory = unpacked + kMaxPointBytes * header.points;
  if (memory <= kUnchecked + kMaxRatio * packed) return {};
  return Refuse(file, 0,
                fmt::format("{} compressed bytes are stated to hold {} points, which would take {} "
                            "MB; expected at most 64 MB and 64 times the compressed data. Save the "
                            "scan as DATA binary",
                            packed, header.points, memory >> 20U));
}

// Two sizes of 4 bytes, then liblzf's stream of the values, field after field.
Expected<PointCloud> ReadCompressed(const PcdHeader& header, const CloudColumns& columns,
                                    std::string_view text, const std::string& file) {
  constexpr std::size_t kSizes = 2 * sizeof(std::uint32_t);
  constexpr std::size_t kMaxGrowth = 132;  // Three compressed bytes expand to at most 264.
  const std::string_view body = text.substr(header.body);
  const std::size_t expected = header.points * header.point_bytes;
  if (body.size() < kSizes) return Refuse(file, 0, "the file ends before its compressed data");
  const auto size_at = [&body](std::size_t byte) {
    return static_cast<std::size_t>(LoadScalar(body.data() + byte, ScalarType::kUint32, false));
  };
  const std::size_t packed = size_at(0);
  const std::size_t unpacked = size_at(sizeof(std::uint32_t));
  if (unpacked != expected) {
    return Refuse(file, 0,
                  fmt::format("the header states {} points of {} bytes, {} bytes in all; the "
                              "compressed data states {}",
                              header.points, header.point_bytes, expected, unpacked));
  }
  if (packed > body.size() - kSizes || unpacked > kMaxGrowth * packed) {
    return Refuse(file, 0,
                  fmt::format("the compressed data is stated to have {} bytes that expand to {}; "
                              "the file has {}",
                              packed, unpacked, body.size() - kSizes));
  }
  SEXTANT_RETURN_IF_ERROR(CheckExpansion(header, unpacked, packed, file));
  std::string data(unpacked, '\0');
  if (unpacked > 0 && lzf_decompress(body.data() + kSizes, static_cast<unsigned>(packed),
                                     data.data(), static_cast<unsigned>(unpacked)) != unpacked) {
    return Refuse(file, 0, "the compressed data is damaged");
  }
  return ReadValues(header, columns, data, true, file);
}

}  // namespace

Expected<PointCloud> ReadPcd(const std::filesystem::path& path) { return ReadWith(path, ParsePcd); }

Expected<PointCloud> ParsePcd(std::string_view text, const std::string& file) {
  SEXTANT_ASSIGN_OR_RETURN(const PcdHeader header, ParsePcdHeader(text, file));
  SEXTANT_ASSIGN_OR_RETURN(const CloudColumns columns, FindFields(header, file));
  switch (header.encoding) {
    case PcdEncoding::kAscii:
      return ReadAscii(header, columns, text, file);
    case PcdEncoding::kBinary:
      return ReadBinary(header, columns, text, file);
    case PcdEncoding::kBinaryCompressed:
      break;
  }
  return ReadCompressed(header, columns, text, file);
}

}  // namespace sextant
