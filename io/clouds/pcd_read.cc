// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <lzf.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <optional>

#include "io/clouds/pcd_file.h"
#include "io/text/line_reader.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

static_assert(std::endian::native == std::endian::little, "PCD data is copied as it stands");

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

// The fields that a PointCloud has; null where the file lacks one.
struct CloudFields {
  const PcdField* xyz[3] = {};
  const PcdField* intensity = nullptr;
  const PcdField* ring = nullptr;
  const PcdField* time = nullptr;
};

/// One point, whatever its types were.
struct Values {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  double intensity = 0.0;
  double ring = 0.0;
  double time = 0.0;
};

tl::unexpected<Error> Refuse(const std::string& file, int line, const std::string& message) {
  return MakeError(ErrorCode::kParse,
                   fmt::format("{}: {}", ToString(Place{.file = file, .line = line}), message));
}

Expected<CloudFields> FindFields(const PcdHeader& header, const std::string& file) {
  CloudFields fields;
  const char* const names[] = {"x", "y", "z"};
  for (std::size_t i = 0; i < 3; ++i) {
    fields.xyz[i] = header.Find(names[i]);
    if (fields.xyz[i] == nullptr) {
      return Refuse(file, 0,
                    fmt::format("expected the fields x, y and z with one value each; {} "
                                "is not among FIELDS",
                                names[i]));
    }
  }
  fields.intensity = header.Find("intensity");
  fields.ring = header.Find("ring");
  for (const char* name : {"time", "t", "timestamp", "time_stamp"}) {
    if (fields.time == nullptr) fields.time = header.Find(name);
  }
  return fields;
}

// NaN for what a float cannot be.
float ToFloat(double value) {
  constexpr double kMax = std::numeric_limits<float>::max();
  return std::abs(value) <= kMax ? static_cast<float>(value)
                                 : std::numeric_limits<float>::quiet_NaN();
}

// Gathers points and judges their values; the first error is kept by its caller.
class PcdCloudBuilder {
 public:
  PcdCloudBuilder(const CloudFields& fields, std::size_t points) : fields_(fields) {
    cloud_.points.reserve(points);
    if (fields.intensity != nullptr) cloud_.intensity.reserve(points);
    if (fields.ring != nullptr) cloud_.ring.reserve(points);
    if (fields.time != nullptr) cloud_.time_s.reserve(points);
  }

  /// Whether the values can be; ring is the only field with a range.
  bool Add(const Values& values) {
    const bool is_return = values.point.allFinite();
    cloud_.points.push_back(is_return ? values.point : Eigen::Vector3d::Constant(kNoNumber));
    if (fields_.intensity != nullptr) {
      cloud_.intensity.push_back(ToFloat(values.intensity));
    }
    if (fields_.time != nullptr) {
      cloud_.time_s.push_back(fields_.time->type == 'F' ? values.time : 1e-9 * values.time);
    }
    if (fields_.ring == nullptr) return true;
    const bool is_ring =
        values.ring >= 0.0 && values.ring <= 65535.0 && values.ring == std::floor(values.ring);
    cloud_.ring.push_back(is_ring ? static_cast<std::uint16_t>(values.ring) : std::uint16_t{0});
    return is_ring || !is_return;
  }

  PointCloud Take() {
    MakeTimesRelative();
    return std::move(cloud_);
  }

 private:
  void MakeTimesRelative() {
    constexpr double kTimeOfDay_s = 1000.0;
    double earliest = std::numeric_limits<double>::infinity();
    for (const double time : cloud_.time_s) {
      if (time < earliest) earliest = time;
    }
    if (!(earliest >= kTimeOfDay_s) || !std::isfinite(earliest)) return;
    for (double& time : cloud_.time_s) time -= earliest;
  }

  CloudFields fields_;
  PointCloud cloud_;
};

constexpr const char* kRingRange = "expected a ring from 0 to 65535, got";

// A number of an ascii file, where "nan" and "inf" are points without a return. A 4-byte float is
// one here too, so that an ascii and a binary file of one scan give the same bits.
double AsciiValue(LineReader& in, const PcdField* field) {
  if (field == nullptr || !in.ok()) return 0.0;
  const std::string_view text = in.Field(field->position);
  double value = 0.0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_whole = stop == text.data() + text.size();
  if (error == std::errc() && is_whole) {
    if (!std::isfinite(value)) return kNoNumber;
    return field->type == 'F' && field->size == 4 ? ToFloat(value) : value;
  }
  return in.Real(field->position, field->name);
}

Expected<PointCloud> ReadAscii(const PcdHeader& header, const CloudFields& fields,
                               std::string_view text, const std::string& file) {
  const std::size_t shortest_point = 2 * header.point_values;
  const std::size_t room = (text.size() - header.body + 1) / shortest_point;
  if (header.points > room) {
    return Refuse(file, 0,
                  fmt::format("the header promises {} points, the file has room for {} at "
                              "most",
                              header.points, room));
  }
  LineReader in(file, text);
  while (in.Next() && in.Field(0) != "DATA") {
  }
  PcdCloudBuilder builder(fields, header.points);
  const std::string row = fmt::format("the {} values of a point", header.point_values);
  for (std::size_t i = 0; i < header.points && in.ok(); ++i) {
    if (!in.Require(row) || !in.HasFields(header.point_values, row)) break;
    Values values;
    for (std::size_t k = 0; k < 3; ++k) {
      values.point[static_cast<int>(k)] = AsciiValue(in, fields.xyz[k]);
    }
    values.intensity = AsciiValue(in, fields.intensity);
    values.ring = AsciiValue(in, fields.ring);
    values.time = AsciiValue(in, fields.time);
    if (!builder.Add(values)) {
      in.Fail(ErrorCode::kParse, fmt::format("{} {}", kRingRange, values.ring));
    }
  }
  if (in.ok() && in.Next()) {
    in.Fail(ErrorCode::kParse,
            fmt::format("expected the end of the file after the {} points of the header",
                        header.points));
  }
  if (!in.ok()) return in.TakeError();
  return builder.Take();
}

template <class T>
double Load(const char* at) {
  T value;
  std::memcpy(&value, at, sizeof(T));
  return static_cast<double>(value);
}

double BinaryValue(const char* at, const PcdField& field) {
  if (field.type == 'F') return field.size == 4 ? Load<float>(at) : Load<double>(at);
  const bool is_signed = field.type == 'I';
  switch (field.size) {
    case 1:
      return is_signed ? Load<std::int8_t>(at) : Load<std::uint8_t>(at);
    case 2:
      return is_signed ? Load<std::int16_t>(at) : Load<std::uint16_t>(at);
    case 4:
      return is_signed ? Load<std::int32_t>(at) : Load<std::uint32_t>(at);
    default:
      return is_signed ? Load<std::int64_t>(at) : Load<std::uint64_t>(at);
  }
}

// The data in memory: point after point, or field after field.
Expected<PointCloud> ReadValues(const PcdHeader& header, const CloudFields& fields,
                                std::string_view data, bool by_field, const std::string& file) {
  const auto value_of = [&](const PcdField* field, std::size_t point) {
    if (field == nullptr) return 0.0;
    const std::size_t at = by_field ? field->offset * header.points + point * field->size
                                    : point * header.point_bytes + field->offset;
    return BinaryValue(data.data() + at, *field);
  };
  PcdCloudBuilder builder(fields, header.points);
  for (std::size_t i = 0; i < header.points; ++i) {
    Values values;
    for (std::size_t k = 0; k < 3; ++k) {
      values.point[static_cast<int>(k)] = value_of(fields.xyz[k], i);
    }
    values.intensity = value_of(fields.intensity, i);
    values.ring = value_of(fields.ring, i);
    values.time = value_of(fields.time, i);
    if (!builder.Add(values)) {
      return Refuse(file, 0, fmt::format("point {}: {} {}", i, kRingRange, values.ring));
    }
  }
  return builder.Take();
}

Expected<PointCloud> ReadBinary(const PcdHeader& header, const CloudFields& fields,
                                std::string_view text, const std::string& file) {
  // The library that defines the format fills up its files to whole pages.
  constexpr std::size_t kMaxPadding = std::size_t{1} << 16;
  const std::string_view data = text.substr(header.body);
  const std::size_t expected = header.points * header.point_bytes;
  if (data.size() < expected || data.size() > expected + kMaxPadding) {
    return Refuse(file, 0,
                  fmt::format("the header promises {} points of {} bytes, {} bytes in "
                              "all; the file has {} after its header",
                              header.points, header.point_bytes, expected, data.size()));
  }
  return ReadValues(header, fields, data, false, file);
}

// Two sizes of 4 bytes, then liblzf's stream of the values field after field.
Expected<PointCloud> ReadCompressed(const PcdHeader& header, const CloudFields& fields,
                                    std::string_view text, const std::string& file) {
  constexpr std::size_t kSizes = 2 * sizeof(std::uint32_t);
  constexpr std::size_t kMaxGrowth = 132;  // Three bytes stand for at most 264.
  const std::string_view body = text.substr(header.body);
  const std::size_t expected = header.points * header.point_bytes;
  if (body.size() < kSizes) return Refuse(file, 0, "the file ends before its compressed data");
  const auto packed = static_cast<std::size_t>(Load<std::uint32_t>(body.data()));
  const auto unpacked =
      static_cast<std::size_t>(Load<std::uint32_t>(body.data() + sizeof(std::uint32_t)));
  if (unpacked != expected) {
    return Refuse(file, 0,
                  fmt::format("the header promises {} points of {} bytes, {} bytes in "
                              "all; the compressed data claims {}",
                              header.points, header.point_bytes, expected, unpacked));
  }
  if (packed > body.size() - kSizes || unpacked > kMaxGrowth * packed) {
    return Refuse(file, 0,
                  fmt::format("the compressed data claims {} bytes that stand for {}; the "
                              "file has {}",
                              packed, unpacked, body.size() - kSizes));
  }
  std::string data(unpacked, '\0');
  if (unpacked > 0 && lzf_decompress(body.data() + kSizes, static_cast<unsigned>(packed),
                                     data.data(), static_cast<unsigned>(unpacked)) != unpacked) {
    return Refuse(file, 0, "the compressed data is damaged");
  }
  return ReadValues(header, fields, data, true, file);
}

}  // namespace

Expected<PointCloud> ReadPcd(const std::filesystem::path& path) { return ReadWith(path, ParsePcd); }

Expected<PointCloud> ParsePcd(std::string_view text, const std::string& file) {
  SEXTANT_ASSIGN_OR_RETURN(const PcdHeader header, ParsePcdHeader(text, file));
  SEXTANT_ASSIGN_OR_RETURN(const CloudFields fields, FindFields(header, file));
  switch (header.encoding) {
    case PcdEncoding::kAscii:
      return ReadAscii(header, fields, text, file);
    case PcdEncoding::kBinary:
      return ReadBinary(header, fields, text, file);
    case PcdEncoding::kBinaryCompressed:
      break;
  }
  return ReadCompressed(header, fields, text, file);
}

}  // namespace sextant
