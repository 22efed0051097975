// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/csv_cloud.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "io/clouds/cloud_builder.h"
#include "io/text/line_reader.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

// The columns of a table and the number of its values in a line.
struct TableForm {
  std::vector<NamedColumn> names{};
  std::size_t fields = 0;  // In a line; one more than names where lines end with a separator.
  bool has_header = false;
  int lines_before = 0;  // Number of the last line before the points.
};

std::optional<double> NumberIn(std::string_view field) {
  double value = 0.0;
  const char* const end = field.data() + field.size();
  const auto [stop, error] = std::from_chars(field.data(), end, value);
  if (field.empty() || stop != end || error != std::errc()) return std::nullopt;
  return value;
}

// Without the empty one after a separator at the line's end.
std::size_t NamedFields(const LineReader& in) {
  const std::size_t count = in.field_count();
  return count > 3 && in.Field(count - 1).empty() ? count - 1 : count;
}

bool IsAllNumbers(const LineReader& in) {
  for (std::size_t i = 0; i < NamedFields(in); ++i) {
    if (!NumberIn(in.Field(i))) return false;
  }
  return true;
}

// A line of one number, the count of the points (.pts), precedes the first point.
LineReader::Separator SeparatorOf(std::string_view text) {
  LineReader in("", text);
  if (in.Next() && in.field_count() == 1 && IsAllNumbers(in)) in.Next();
  if (in.field_count() == 0) return LineReader::Separator::kCommas;
  // The whole line: a header may have blanks in its names.
  const char* const begin = in.Field(0).data();
  const std::string_view rest(begin, static_cast<std::size_t>(text.data() + text.size() - begin));
  const std::string_view line = rest.substr(0, rest.find('\n'));
  if (line.find(';') != std::string_view::npos) return LineReader::Separator::kSemicolons;
  return line.find(',') != std::string_view::npos ? LineReader::Separator::kCommas
                                                  : LineReader::Separator::kBlanks;
}

// Whether the numbers have decimal commas, between values that semicolons or tabs separate.
bool HasDecimalCommas(std::string_view text) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const std::string_view head = text.substr(0, 4096);
  const bool separated = head.find_first_of(";\t") != std::string_view::npos;
  for (std::size_t i = 1; separated && i + 1 < head.size(); ++i) {
    if (head[i] != ',') continue;
    if (!is_digit(head[i - 1]) || !is_digit(head[i + 1])) return false;
    const std::size_t line = head.rfind('\n', i) + 1;  // 0 in the first line.
    const std::string_view row = head.substr(line, head.find('\n', i) - line);
    if (row.find_first_of(";\t") == std::string_view::npos) return false;
  }
  return separated && head.find(',') != std::string_view::npos;
}

TableForm ReadForm(LineReader& in) {
  TableForm form;
  if (!in.Require("a header line with the names of the columns")) return form;
  if (in.field_count() == 1 && IsAllNumbers(in)) {
    form.lines_before = in.line();
    if (!in.Require("points")) return form;
  }
  form.has_header = !IsAllNumbers(in);
  if (form.has_header) form.lines_before = in.line();
  form.fields = in.field_count();
  for (std::size_t i = 0; i < NamedFields(in); ++i) {
    form.names.push_back({.name = form.has_header ? std::string(in.Field(i)) : std::string()});
  }
  return form;
}

// Goes to the next line with a point.
bool NextPoint(LineReader& in, const TableForm& form) {
  while (in.Next()) {
    if (in.line() > form.lines_before) return true;
  }
  return false;
}

// Whether every fifth value of a table without names is a ring.
bool HasRingColumn(LineReader in, const TableForm& form) {
  if (form.names.size() != 5) return false;
  while (NextPoint(in, form)) {
    if (in.field_count() >= 5 && !IsRingNumber(NumberIn(in.Field(4)).value_or(-1.0))) return false;
  }
  return true;
}

Expected<CloudColumns> ColumnsOf(const TableForm& form, const LineReader& start) {
  if (form.has_header) return FindCloudColumns(form.names);
  if (form.names.size() >= 3) {
    return UnnamedColumns(form.names.size(), HasRingColumn(start, form));
  }
  return MakeError(ErrorCode::kParse,
                   fmt::format("expected x, y and z in each line, got {} value{}",
                               form.names.size(), form.names.size() == 1 ? "" : "s"));
}

}  // namespace

Expected<PointCloud> ReadCsvCloud(const std::filesystem::path& path) {
  return ReadWith(path, ParseCsvCloud);
}

Expected<PointCloud> ParseCsvCloud(std::string_view text, const std::string& file) {
  if (HasDecimalCommas(text)) {
    std::string with_points(text);
    std::ranges::replace(with_points, ',', '.');
    return ParseCsvCloud(with_points, file);
  }
  const LineReader start(file, text, SeparatorOf(text));
  LineReader in = start;
  const TableForm form = ReadForm(in);
  if (!in.ok()) return in.TakeError();
  const Expected<CloudColumns> columns = ColumnsOf(form, start);
  if (!columns) {
    in.Fail(columns.error().code, columns.error().message);
    return in.TakeError();
  }
  in = start;
  const std::string row =
      fmt::format("{} values as in the {}", form.fields, form.has_header ? "header" : "first line");
  CloudBuilder builder(*columns);
  while (NextPoint(in, form) && in.HasFields(form.fields, row)) {
    const Expected<void> added = builder.Add([&](std::size_t column) {
      const std::string& name = form.names[column].name;
      const Place place{.file = file, .line = in.line(), .field = column + 1, .name = name};
      Expected<double> value = ParseFinite(in.Field(column), place);
      if (value) return *value;
      if (value.error().code == ErrorCode::kParse) in.Fail(std::move(value.error()));
      return std::numeric_limits<double>::quiet_NaN();
    });
    if (!added) in.Fail(added.error().code, added.error().message);
  }
  if (in.ok() && builder.size() == 0) {
    in.Fail(ErrorCode::kParse, "expected points after the header");
  }
  if (!in.ok()) return in.TakeError();
  return std::move(builder).Finish();
}

}  // namespace sextant
