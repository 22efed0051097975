// SPDX-License-Identifier: Apache-2.0
#include "base/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/nearest_name.h"

namespace sextant {
namespace {

template <class Number>
bool ParseWhole(const std::string& text, Number& value) {
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(begin, end, value);
  return error == std::errc() && stop == end;
}

}  // namespace

std::string FormatReal(double value) { return fmt::format("{:g}", value); }

Expected<double> ParseReal(const std::string& name, const std::string& text, double low,
                           double high) {
  double value = 0.0;
  if (!ParseWhole(text, value) || !std::isfinite(value) || value < low || value > high) {
    return MakeError(
        ErrorCode::kInvalidOption,
        fmt::format("option {}={}: expected a number from {:g} to {:g}", name, text, low, high));
  }
  return value;
}

Expected<std::int64_t> ParseCount(const std::string& name, const std::string& text,
                                  std::int64_t low, std::int64_t high) {
  std::int64_t value = 0;
  if (!ParseWhole(text, value) || value < low || value > high) {
    return MakeError(
        ErrorCode::kInvalidOption,
        fmt::format("option {}={}: expected a whole number from {} to {}", name, text, low, high));
  }
  return value;
}

Expected<std::size_t> ParseChoice(const std::string& name, const std::string& text,
                                  const std::vector<std::string>& choices) {
  const auto found = std::find(choices.begin(), choices.end(), text);
  if (found == choices.end()) {
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("option {}={}: expected {}; {}", name, text,
                                 fmt::join(choices, " or "), SuggestName(text, choices)));
  }
  return static_cast<std::size_t>(found - choices.begin());
}

Expected<unsigned> ParseSet(const std::string& name, const std::string& text,
                            const std::vector<std::string>& choices) {
  if (text == "none") return 0U;
  unsigned bits = 0;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('+', begin), text.size());
    const std::string part = text.substr(begin, end - begin);
    const auto found = std::find(choices.begin(), choices.end(), part);
    if (found == choices.end()) {
      return MakeError(
          ErrorCode::kInvalidOption,
          fmt::format("option {}={}: expected none, or any of {} joined by +; {}", name, text,
                      fmt::join(choices, ", "), SuggestName(part, choices)));
    }
    bits |= 1U << static_cast<unsigned>(found - choices.begin());
    begin = end + 1;
  }
  return bits;
}

}  // namespace sextant
