// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/ply_header.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>

#include "io/text/number_text.h"

namespace sextant {
namespace {

constexpr std::size_t kMaxBytesOfLine = 1000;
constexpr int kMaxLines = 1000;

using Words = std::vector<std::string_view>;

constexpr std::array<std::pair<std::string_view, ScalarType>, 16> kTypes = {{
    {"char", ScalarType::kInt8},
    {"int8", ScalarType::kInt8},
    {"uchar", ScalarType::kUint8},
    {"uint8", ScalarType::kUint8},
    {"short", ScalarType::kInt16},
    {"int16", ScalarType::kInt16},
    {"ushort", ScalarType::kUint16},
    {"uint16", ScalarType::kUint16},
    {"int", ScalarType::kInt32},
    {"int32", ScalarType::kInt32},
    {"uint", ScalarType::kUint32},
    {"uint32", ScalarType::kUint32},
    {"float", ScalarType::kFloat32},
    {"float32", ScalarType::kFloat32},
    {"double", ScalarType::kFloat64},
    {"float64", ScalarType::kFloat64},
}};

Words Split(std::string_view line) {
  Words words;
  while (true) {
    line.remove_prefix(std::min(line.find_first_not_of(" \t\r"), line.size()));
    if (line.empty()) return words;
    const std::size_t end = std::min(line.find_first_of(" \t\r"), line.size());
    words.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
}

class HeaderParser {
 public:
  HeaderParser(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  Expected<PlyHeader> Parse() {
    if (!NextLine() || words_ != Words{"ply"}) Fail("expected 'ply'");
    if (!NextLine() || words_.empty() || words_[0] != "format") Fail("expected 'format'");
    ParseFormat();
    while (!error_) {
      if (!NextLine()) {
        Fail("the header ends here, expected 'end_header'");
      } else if (words_.empty() || words_[0] == "comment" || words_[0] == "obj_info") {
        continue;
      } else if (words_[0] == "end_header") {
        break;
      } else if (words_[0] == "element") {
        ParseElement();
      } else if (words_[0] == "property") {
        ParseProperty();
      } else {
        Fail(fmt::format("expected element, property, comment or end_header, got {}",
                         Quoted(words_[0])));
      }
    }
    if (error_) return tl::unexpected<Error>(*error_);
    return std::move(header_);
  }

 private:
  bool NextLine() {
    words_.clear();
    if (error_) return false;
    const std::string_view rest = bytes_.substr(header_.size);
    const std::size_t end = rest.substr(0, kMaxBytesOfLine).find('\n');
    if (rest.empty() || header_.lines == kMaxLines) return false;
    ++header_.lines;
    if (end == std::string_view::npos) {
      Fail(fmt::format("expected a line of at most {} bytes that ends in a line feed",
                       kMaxBytesOfLine));
      return false;
    }
    header_.size += end + 1;
    words_ = Split(rest.substr(0, end));
    return true;
  }

  void Fail(std::string_view what) {
    if (error_) return;
    const Place place{.file = file_, .line = std::max(header_.lines, 1)};
    error_ = Error{ErrorCode::kParse, fmt::format("{}: {}", ToString(place), what)};
  }

  void ParseFormat() {
    if (error_) return;
    const std::string_view name = words_.size() == 3 ? words_[1] : "";
    if (name == "binary_little_endian") {
      header_.encoding = PlyEncoding::kLittleEndian;
    } else if (name == "binary_big_endian") {
      header_.encoding = PlyEncoding::kBigEndian;
    } else if (name != "ascii") {
      Fail("expected 'format', then ascii, binary_little_endian or binary_big_endian, then 1.0");
    }
  }

  void ParseElement() {
    if (words_.size() != 3) return Fail("expected 'element', a name and a count");
    const Expected<std::int64_t> count =
        ParseInteger(words_[2], 0, std::numeric_limits<std::int64_t>::max(),
                     {.file = file_, .line = header_.lines, .field = 3, .name = "count"});
    if (!count) {
      if (!error_) error_ = count.error();
      return;
    }
    header_.elements.push_back({std::string(words_[1]), static_cast<std::size_t>(*count), {}});
  }

  ScalarType TypeOf(std::string_view name) {
    for (const auto& [known, type] : kTypes) {
      if (known == name) return type;
    }
    Fail(
        fmt::format("unknown type {}, expected char, uchar, short, ushort, int, uint, float or "
                    "double",
                    Quoted(name)));
    return ScalarType::kFloat32;
  }

  void ParseProperty() {
    if (header_.elements.empty()) return Fail("expected 'element' before its properties");
    PlyProperty property;
    property.is_list = words_.size() == 5 && words_[1] == "list";
    if (property.is_list) {
      property.length_type = TypeOf(words_[2]);
      if (!IsInteger(property.length_type)) Fail("expected a length of an integer type");
    } else if (words_.size() != 3) {
      return Fail(
          "expected 'property', a type and a name, or 'property list', two types and a name");
    }
    property.type = TypeOf(words_[words_.size() - 2]);
    property.name = std::string(words_.back());
    header_.elements.back().properties.push_back(std::move(property));
  }

  std::string_view bytes_;
  const std::string& file_;
  PlyHeader header_;
  Words words_;
  std::optional<Error> error_;
};

}  // namespace

Expected<PlyHeader> ParsePlyHeader(std::string_view bytes, const std::string& file) {
  return HeaderParser(bytes, file).Parse();
}

}  // namespace sextant
