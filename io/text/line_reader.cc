// SPDX-License-Identifier: Apache-2.0
#include "io/text/line_reader.h"

#include <fmt/core.h>

#include <algorithm>

namespace sextant {
namespace {

constexpr std::string_view kBlank = " \t\r\f\v";
// Without a limit, a line of commas alone would take sixteen times its size in memory.
constexpr std::size_t kMaxFields = 1000;

std::string_view Trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

// The end of a field in double quotes, within which marks are text; none for another field.
std::size_t ClosingQuote(std::string_view line) {
  const std::size_t first = line.find_first_not_of(kBlank);
  if (first == std::string_view::npos || line[first] != '"') return std::string_view::npos;
  return line.find('"', first + 1);
}

}  // namespace

LineReader::LineReader(std::string file, std::string_view text, Separator separator)
    : file_(std::move(file)), rest_(text), separator_(separator) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
}

std::string_view LineReader::TakeLine() {
  const std::size_t end = std::min(rest_.find('\n'), rest_.size());
  const std::string_view line = Trim(rest_.substr(0, end));
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  ++line_;
  return line;
}

bool LineReader::Next() {
  while (ok() && !rest_.empty()) {
    const std::string_view line = TakeLine();
    if (line.empty() || line.starts_with('#')) continue;
    Split(line);
    return ok();
  }
  return false;
}

bool LineReader::AtEnd() const {
  LineReader ahead = *this;
  return !ahead.Next();
}

void LineReader::Split(std::string_view line) {
  fields_.clear();
  const bool blanks = separator_ == Separator::kBlanks;
  const char mark = separator_ == Separator::kSemicolons ? ';' : ',';
  while (true) {
    std::size_t end = blanks ? line.find_first_of(kBlank) : line.find(mark);
    const std::size_t closing = blanks ? std::string_view::npos : ClosingQuote(line);
    if (closing != std::string_view::npos) end = line.find(mark, closing);
    const std::string_view field = Trim(line.substr(0, end));
    const bool is_quoted = closing != std::string_view::npos && field.back() == '"';
    fields_.push_back(is_quoted ? field.substr(1, field.size() - 2) : field);
    if (end == std::string_view::npos) return;
    if (fields_.size() == kMaxFields) {
      return Fail(ErrorCode::kParse,
                  fmt::format("expected at most {} fields in a line", kMaxFields));
    }
    line.remove_prefix(end + 1);
    if (blanks) line = Trim(line);
  }
}

bool LineReader::Require(std::string_view what) {
  if (Next()) return true;
  fields_.clear();
  Fail(ErrorCode::kParse, fmt::format("the file ends here, expected {}", what));
  return false;
}

bool LineReader::HasFields(std::size_t count, std::string_view what) {
  if (!ok()) return false;
  if (fields_.size() == count) return true;
  Fail(ErrorCode::kParse, fmt::format("expected {}, got {} field{} ({})", what, fields_.size(),
                                      fields_.size() == 1 ? "" : "s", Quoted(fields_[0])));
  return false;
}

double LineReader::Real(std::size_t index, std::string_view name) {
  return ok() ? RealOf(fields_[index], index, name) : 0.0;
}

double LineReader::RealOf(std::string_view text, std::size_t index, std::string_view name) {
  if (!ok()) return 0.0;
  Expected<double> value =
      ParseFinite(text, {.file = file_, .line = line_, .field = index + 1, .name = name});
  if (value) return *value;
  Fail(std::move(value.error()));
  return 0.0;
}

std::int64_t LineReader::Integer(std::size_t index, std::int64_t low, std::int64_t high,
                                 std::string_view name) {
  return ok() ? IntegerOf(fields_[index], index, low, high, name) : 0;
}

std::int64_t LineReader::IntegerOf(std::string_view text, std::size_t index, std::int64_t low,
                                   std::int64_t high, std::string_view name) {
  if (!ok()) return 0;
  Expected<std::int64_t> value = ParseInteger(
      text, low, high, {.file = file_, .line = line_, .field = index + 1, .name = name});
  if (value) return *value;
  Fail(std::move(value.error()));
  return 0;
}

void LineReader::Fail(ErrorCode code, std::string_view message) {
  Fail({code, fmt::format("{}: {}", ToString(Place{.file = file_, .line = std::max(line_, 1)}),
                          message)});
}

void LineReader::Fail(Error error) {
  if (ok()) error_ = std::move(error);
}

tl::unexpected<Error> LineReader::TakeError() { return tl::unexpected<Error>(*error_); }

}  // namespace sextant
