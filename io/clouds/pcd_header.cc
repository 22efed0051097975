// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/pcd_header.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <optional>

#include "base/nearest_name.h"
#include "io/text/line_reader.h"

namespace sextant {
namespace {

// In the order of PcdEncoding.
const std::array<std::string, 3>& EncodingNames() {
  static const std::array<std::string, 3> names = {"ascii", "binary", "binary_compressed"};
  return names;
}

constexpr std::int64_t kMaxPoints = 1'000'000'000;
constexpr std::int64_t kMaxCount = 1'000'000;
constexpr std::size_t kMaxPcdFields = 256;
constexpr std::size_t kMaxHeaderBytes = std::size_t{1} << 16;

// The content of the header's lines; absent ones are empty.
struct Lines {
  std::vector<PcdField> fields{};
  bool has_sizes = false;
  bool has_types = false;
  std::optional<std::int64_t> width{};
  std::optional<std::int64_t> height{};
  std::optional<std::int64_t> points{};
  std::optional<PcdEncoding> encoding{};
};

// The byte after the line DATA; npos if there is no such line.
std::size_t FindBody(std::string_view text) {
  const std::string_view head = text.substr(0, kMaxHeaderBytes);
  std::size_t line = 0;
  while (line < head.size()) {
    const std::size_t end = head.find('\n', line);
    if (end == std::string_view::npos) return std::string_view::npos;
    if (head.substr(line, end - line).starts_with("DATA")) return end + 1;
    line = end + 1;
  }
  return std::string_view::npos;
}

void ReadNames(LineReader& in, Lines& lines) {
  if (in.field_count() < 2 || in.field_count() > kMaxPcdFields + 1) {
    in.Fail(ErrorCode::kParse, fmt::format("expected FIELDS with 1 to {} names", kMaxPcdFields));
    return;
  }
  for (std::size_t i = 1; i < in.field_count(); ++i) {
    PcdField field;
    field.name = std::string(in.Field(i));
    const bool is_padding = field.name == "_";
    const bool is_known = std::any_of(lines.fields.begin(), lines.fields.end(),
                                      [&](const PcdField& f) { return f.name == field.name; });
    if (is_known && !is_padding) {
      in.Fail(ErrorCode::kParse, fmt::format("the field {} is named twice", Quoted(field.name)));
    }
    lines.fields.push_back(std::move(field));
  }
}

// Whether the line has one value per field of FIELDS.
bool HasOnePerField(LineReader& in, const Lines& lines) {
  const std::size_t expected = lines.fields.size();
  if (!in.ok() || (expected > 0 && in.field_count() == expected + 1)) return in.ok();
  in.Fail(ErrorCode::kParse, fmt::format("expected one value for each of the {} FIELDS, got {}",
                                         expected, in.field_count() - 1));
  return false;
}

void ReadSizes(LineReader& in, Lines& lines) {
  if (!HasOnePerField(in, lines)) return;
  lines.has_sizes = true;
  for (std::size_t i = 0; i < lines.fields.size(); ++i) {
    const std::int64_t size = in.Integer(i + 1, 1, 8, "SIZE");
    if (in.ok() && size != 1 && size != 2 && size != 4 && size != 8) {
      in.Fail(ErrorCode::kParse,
              fmt::format("expected a size of 1, 2, 4 or 8 bytes, got {}", size));
    }
    lines.fields[i].size = static_cast<std::size_t>(size);
  }
}

void ReadTypes(LineReader& in, Lines& lines) {
  if (!HasOnePerField(in, lines)) return;
  lines.has_types = true;
  for (std::size_t i = 0; i < lines.fields.size(); ++i) {
    const std::string_view type = in.Field(i + 1);
    if (type != "F" && type != "U" && type != "I") {
      in.Fail(ErrorCode::kParse, fmt::format("expected the types F, U or I, got {}", Quoted(type)));
      return;
    }
    lines.fields[i].type = type.front();
  }
}

void ReadCounts(LineReader& in, Lines& lines) {
  if (!HasOnePerField(in, lines)) return;
  for (std::size_t i = 0; i < lines.fields.size(); ++i) {
    PcdField& field = lines.fields[i];
    field.count = static_cast<std::size_t>(in.Integer(i + 1, 0, kMaxCount, "COUNT"));
    // PCL writes 0 for the one value of messages whose fields state no count.
    if (field.count == 0 && field.name != "_") field.count = 1;
  }
}

std::optional<std::int64_t> ReadNumber(LineReader& in, std::string_view name) {
  if (!in.HasFields(2, name)) return std::nullopt;
  return in.Integer(1, 0, kMaxPoints, name);
}

void ReadEncoding(LineReader& in, Lines& lines) {
  if (!in.HasFields(2, "DATA ascii, binary or binary_compressed")) return;
  const Expected<PcdEncoding> encoding = FindPcdEncoding(in.Field(1));
  if (encoding) {
    lines.encoding = *encoding;
  } else {
    in.Fail(ErrorCode::kParse, encoding.error().message);
  }
}

void ReadLine(LineReader& in, Lines& lines) {
  static const std::array<std::string, 10> kKeys = {"VERSION", "FIELDS", "SIZE",   "TYPE",
                                                    "COUNT",   "WIDTH",  "HEIGHT", "VIEWPOINT",
                                                    "POINTS",  "DATA"};
  const std::string_view key = in.Field(0);
  if (key == "FIELDS" || key == "COLUMNS") return ReadNames(in, lines);
  if (key == "SIZE") return ReadSizes(in, lines);
  if (key == "TYPE") return ReadTypes(in, lines);
  if (key == "COUNT") return ReadCounts(in, lines);
  if (key == "DATA") return ReadEncoding(in, lines);
  if (key == "WIDTH") lines.width = ReadNumber(in, "WIDTH");
  if (key == "HEIGHT") lines.height = ReadNumber(in, "HEIGHT");
  if (key == "POINTS") lines.points = ReadNumber(in, "POINTS");
  if (std::find(kKeys.begin(), kKeys.end(), key) == kKeys.end()) {
    in.Fail(ErrorCode::kParse, fmt::format("unknown line {} in the header of a PCD file; {}",
                                           Quoted(key), SuggestName(key.substr(0, 40), kKeys)));
  }
}

void RequireWhole(LineReader& in, const Lines& lines) {
  const char* missing = nullptr;
  if (lines.fields.empty()) missing = "FIELDS";
  if (!lines.has_sizes) missing = "SIZE";
  if (!lines.has_types) missing = "TYPE";
  if (!lines.width && !lines.points) missing = "WIDTH";
  if (missing != nullptr) {
    in.Fail(ErrorCode::kParse, fmt::format("the header ends here without a line {}", missing));
  }
  for (const PcdField& field : lines.fields) {
    if (field.type == 'F' && field.size < 4) {
      in.Fail(ErrorCode::kParse, fmt::format("the field {} is floating point of {} bytes, expected "
                                             "4 or 8",
                                             Quoted(field.name), field.size));
    }
  }
}

std::size_t PointCount(LineReader& in, const Lines& lines) {
  if (!lines.width) return static_cast<std::size_t>(lines.points.value_or(0));
  const std::int64_t product = *lines.width * lines.height.value_or(1);
  if (product > kMaxPoints) {
    in.Fail(ErrorCode::kParse, fmt::format("expected at most {} points, but WIDTH x HEIGHT is {}",
                                           kMaxPoints, product));
  }
  if (lines.points && *lines.points != product) {
    in.Fail(ErrorCode::kParse, fmt::format("the header is inconsistent: POINTS is {}, but WIDTH x "
                                           "HEIGHT is {}",
                                           *lines.points, product));
  }
  return static_cast<std::size_t>(product);
}

}  // namespace

Expected<PcdEncoding> FindPcdEncoding(std::string_view name) {
  const auto found = std::find(EncodingNames().begin(), EncodingNames().end(), name);
  if (found != EncodingNames().end()) {
    return static_cast<PcdEncoding>(found - EncodingNames().begin());
  }
  return MakeError(ErrorCode::kUnknownName,
                   fmt::format("unknown encoding {}; {}", Quoted(name),
                               SuggestName(name.substr(0, 40), EncodingNames())));
}

std::string_view ToString(PcdEncoding encoding) {
  return EncodingNames()[static_cast<std::size_t>(encoding)];
}

ScalarType PcdField::scalar_type() const {
  if (type == 'F') return size == 4 ? ScalarType::kFloat32 : ScalarType::kFloat64;
  const bool is_signed = type == 'I';
  if (size == 1) return is_signed ? ScalarType::kInt8 : ScalarType::kUint8;
  if (size == 2) return is_signed ? ScalarType::kInt16 : ScalarType::kUint16;
  if (size == 4) return is_signed ? ScalarType::kInt32 : ScalarType::kUint32;
  return is_signed ? ScalarType::kInt64 : ScalarType::kUint64;
}

Expected<PcdHeader> ParsePcdHeader(std::string_view text, const std::string& file) {
  const std::size_t body = FindBody(text);
  if (body == std::string_view::npos) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}: expected a PCD file: a header that ends with a line DATA",
                                 ToString(Place{.file = file})));
  }
  LineReader in(file, text.substr(0, body));
  Lines lines;
  while (!lines.encoding && in.Next()) ReadLine(in, lines);
  RequireWhole(in, lines);
  PcdHeader header;
  header.points = PointCount(in, lines);
  if (!in.ok()) return in.TakeError();
  header.body_line = in.line() + 1;
  header.encoding = *lines.encoding;
  header.body = body;
  for (PcdField& field : lines.fields) {
    field.offset = header.point_bytes;
    field.position = header.point_values;
    header.point_bytes += field.size * field.count;
    header.point_values += field.count;
  }
  header.fields = std::move(lines.fields);
  return header;
}

}  // namespace sextant
