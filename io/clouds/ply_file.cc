// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/ply_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "base/text/path_text.h"
#include "io/clouds/cloud_builder.h"
#include "io/clouds/ply_header.h"
#include "io/text/number_text.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

constexpr std::string_view kPlyBlank = " \t\r\n\f\v";

// Reads the numbers of the body one after the other and keeps the first error.
class Body {
 public:
  Body(std::string_view bytes, const std::string& file, const PlyHeader& header)
      : bytes_(bytes),
        file_(file),
        at_(header.size),
        line_(header.lines + 1),
        encoding_(header.encoding) {}

  bool ok() const { return !error_; }
  tl::unexpected<Error> TakeError() { return tl::unexpected<Error>(*error_); }
  std::size_t bytes_left() const { return bytes_.size() - at_; }

  // Sets the row of the numbers that are read next, for error messages.
  void SetRow(const PlyElement& element, std::size_t row) {
    element_ = &element;
    row_ = row;
  }

  double Number(ScalarType type, std::string_view property) {
    if (error_) return 0.0;
    return encoding_ == PlyEncoding::kAscii ? AsciiNumber(property) : BinaryNumber(type, property);
  }

  void Fail(ErrorCode code, std::string_view property, std::string_view what) {
    if (error_) return;
    const bool ascii = encoding_ == PlyEncoding::kAscii;
    const std::string place = ToString(Place{.file = file_, .line = ascii ? line_ : 0});
    error_ = Error{
        code, fmt::format("{}: {}{} {}{}{}: {}", place, ascii ? "" : fmt::format("byte {}: ", at_),
                          Printable(element_->name, 40), row_, property.empty() ? "" : ": ",
                          Printable(property, 40), what)};
  }

 private:
  double FailAtEnd(std::string_view property) {
    Fail(ErrorCode::kParse, property, "the file ends here; it is cut short or its header is wrong");
    return 0.0;
  }

  double BinaryNumber(ScalarType type, std::string_view property) {
    if (bytes_left() < SizeOf(type)) return FailAtEnd(property);
    const double value =
        LoadScalar(bytes_.data() + at_, type, encoding_ == PlyEncoding::kBigEndian);
    at_ += SizeOf(type);
    return value;
  }

  double AsciiNumber(std::string_view property) {
    while (at_ < bytes_.size() && kPlyBlank.find(bytes_[at_]) != std::string_view::npos) {
      line_ += bytes_[at_] == '\n' ? 1 : 0;
      ++at_;
    }
    const std::size_t end = std::min(bytes_.find_first_of(kPlyBlank, at_), bytes_.size());
    const std::string_view word = bytes_.substr(at_, end - at_);
    if (word.empty()) return FailAtEnd(property);
    const Expected<double> value = ParseFinite(word, {.file = file_});
    at_ = end;
    if (value) return *value;
    // Many tools write a ray without a return as NaN.
    if (value.error().code == ErrorCode::kNonFinite)
      return std::numeric_limits<double>::quiet_NaN();
    Fail(ErrorCode::kParse, property, fmt::format("expected a number, got {}", Quoted(word)));
    return 0.0;
  }

  std::string_view bytes_;
  const std::string& file_;
  std::size_t at_;
  int line_;
  PlyEncoding encoding_;
  const PlyElement* element_ = nullptr;
  std::size_t row_ = 0;
  std::optional<Error> error_;
};

// The minimum size of a row of the element in bytes.
std::size_t MinRowSize(const PlyElement& element, PlyEncoding encoding) {
  std::size_t size = 0;
  for (const PlyProperty& property : element.properties) {
    const ScalarType first = property.is_list ? property.length_type : property.type;
    size += encoding == PlyEncoding::kAscii ? 2 : SizeOf(first);
  }
  return size;
}

// Refuses a count that exceeds what the rest of the file can hold, before any row is read.
void CheckCount(const PlyElement& element, PlyEncoding encoding, Body& body) {
  body.SetRow(element, 0);
  const std::size_t min_size = MinRowSize(element, encoding);
  if (element.count == 0) return;
  if (min_size == 0) return body.Fail(ErrorCode::kParse, "", "its element has no property");
  // The last number of an ascii file need not be followed by white space.
  const std::size_t max_rows = (body.bytes_left() + 1) / min_size;
  if (element.count <= max_rows) return;
  body.Fail(ErrorCode::kParse, "",
            fmt::format("the header states {} rows, but the {} bytes that follow have room for {}",
                        element.count, body.bytes_left(), max_rows));
}

// Reads one row; `values` receives the numbers of its properties, 0 for a list.
void ReadRow(const PlyElement& element, Body& body, std::vector<double>& values) {
  values.assign(element.properties.size(), 0.0);
  for (std::size_t i = 0; i < values.size() && body.ok(); ++i) {
    const PlyProperty& property = element.properties[i];
    if (!property.is_list) {
      values[i] = body.Number(property.type, property.name);
      continue;
    }
    const double length = body.Number(property.length_type, property.name);
    if (!(length >= 0.0)) body.Fail(ErrorCode::kParse, property.name, "expected a length >= 0");
    for (double k = 0.0; k < length && body.ok(); ++k) body.Number(property.type, property.name);
  }
}

Expected<CloudColumns> VertexColumns(const PlyElement& vertex, const std::string& file) {
  std::vector<NamedColumn> columns;
  for (const PlyProperty& property : vertex.properties) {
    columns.push_back({property.is_list ? "" : property.name, IsInteger(property.type)});
  }
  return AtPlace(FindCloudColumns(columns), {.file = file, .name = "element vertex"});
}

}  // namespace

Expected<PointCloud> ReadPly(const std::filesystem::path& path) { return ReadWith(path, ParsePly); }

Expected<PointCloud> ParsePly(std::string_view bytes, const std::string& file) {
  SEXTANT_ASSIGN_OR_RETURN(const PlyHeader header, ParsePlyHeader(bytes, file));
  Body body(bytes, file, header);
  std::vector<double> values;
  for (const PlyElement& element : header.elements) {
    CheckCount(element, header.encoding, body);
    if (!body.ok()) return body.TakeError();
    const bool is_vertex = element.name == "vertex";
    CloudColumns columns;
    if (is_vertex) {
      SEXTANT_ASSIGN_OR_RETURN(const CloudColumns found, VertexColumns(element, file));
      columns = found;
    }
    CloudBuilder builder(columns, is_vertex ? element.count : 0);
    for (std::size_t row = 0; row < element.count && body.ok(); ++row) {
      body.SetRow(element, row);
      ReadRow(element, body, values);
      if (!body.ok() || !is_vertex) continue;
      const Expected<void> added = builder.Add([&](std::size_t column) { return values[column]; });
      if (!added) body.Fail(added.error().code, "", added.error().message);
    }
    if (!body.ok()) return body.TakeError();
    if (is_vertex) return std::move(builder).Finish();
  }
  return MakeError(ErrorCode::kParse,
                   fmt::format("{}: expected an element 'vertex'", PathText(file)));
}

}  // namespace sextant
