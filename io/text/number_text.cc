// SPDX-License-Identifier: Apache-2.0
#include "io/text/number_text.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/text/path_text.h"

namespace sextant {
namespace {

template <class Number>
std::errc ParseWhole(std::string_view text, Number& value) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return stop == text.data() + text.size() ? error : std::errc::invalid_argument;
}

// YAML spells these numbers .nan and .inf.
bool NamesNonFinite(std::string_view text) {
  std::string lower;
  for (const char c : text.substr(0, 10)) {
    lower += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  std::string_view name = lower;
  if (name.starts_with('+') || name.starts_with('-')) name.remove_prefix(1);
  return name == ".nan" || name == ".inf" || name.starts_with("nan") || name == "inf" ||
         name == "infinity";
}

std::string_view CommaHint(std::string_view text) {
  std::string with_point(text.substr(0, 40));
  if (std::count(with_point.begin(), with_point.end(), ',') != 1) return "";
  std::replace(with_point.begin(), with_point.end(), ',', '.');
  double value = 0.0;
  return ParseWhole<double>(with_point, value) == std::errc() ? " (decimal comma? use a point)"
                                                              : "";
}

}  // namespace

std::string ToString(const Place& place) {
  std::string text = PathText(place.file);
  if (place.line > 0) text += fmt::format(":{}", place.line);
  if (place.field > 0) text += fmt::format(": field {}", place.field);
  if (!place.name.empty()) {
    const std::string name = Printable(place.name, 60);
    text += place.field > 0 ? fmt::format(" ({})", name) : fmt::format(": {}", name);
  }
  return text;
}

Expected<double> ParseFinite(std::string_view text, const Place& place) {
  double value = 0.0;
  const std::errc error = ParseWhole(text, value);
  if (error == std::errc() && std::isfinite(value)) return value;
  if (NamesNonFinite(text)) {
    return MakeError(ErrorCode::kNonFinite, fmt::format("{}: expected a finite number, got {}",
                                                        ToString(place), Quoted(text)));
  }
  if (error == std::errc::result_out_of_range) {
    return MakeError(ErrorCode::kNonFinite,
                     fmt::format("{}: expected a number within the range of a double, got {}",
                                 ToString(place), Quoted(text)));
  }
  return MakeError(ErrorCode::kParse, fmt::format("{}: expected a number, got {}{}",
                                                  ToString(place), Quoted(text), CommaHint(text)));
}

Expected<std::int64_t> ParseInteger(std::string_view text, std::int64_t low, std::int64_t high,
                                    const Place& place) {
  std::int64_t value = 0;
  if (ParseWhole(text, value) != std::errc() || value < low || value > high) {
    const std::string expected =
        low == high ? std::to_string(low) : fmt::format("a whole number from {} to {}", low, high);
    return MakeError(ErrorCode::kParse, fmt::format("{}: expected {}, got {}", ToString(place),
                                                    expected, Quoted(text)));
  }
  return value;
}

}  // namespace sextant
