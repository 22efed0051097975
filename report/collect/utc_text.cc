// SPDX-License-Identifier: Apache-2.0
#include "report/collect/utc_text.h"

#include <fmt/core.h>

#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string_view>

namespace sextant {
namespace {

using Seconds = std::chrono::sys_seconds;

std::string DayText(const std::chrono::year_month_day& day) {
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(day.year()),
                     static_cast<unsigned>(day.month()), static_cast<unsigned>(day.day()));
}

std::string TimeText(const Seconds& time, std::string_view between, std::string_view after) {
  const auto day = std::chrono::floor<std::chrono::days>(time);
  const std::chrono::hh_mm_ss clock(time - day);
  return fmt::format("{}{}{:02}:{:02}:{:02}{}", DayText(day), between, clock.hours().count(),
                     clock.minutes().count(), clock.seconds().count(), after);
}

}  // namespace

std::string UtcText(std::chrono::sys_seconds time) { return TimeText(time, " ", " UTC"); }
std::string UtcIsoText(std::chrono::sys_seconds time) { return TimeText(time, "T", "Z"); }

std::string UtcText(double seconds) {
  constexpr double kYear1980 = 315'532'800.0;
  constexpr double kYear2200 = 7'258'118'400.0;
  if (!(seconds > kYear1980 && seconds < kYear2200)) return {};
  return UtcText(Seconds{std::chrono::seconds(static_cast<long long>(std::floor(seconds)))});
}

std::string TodayText() {
  Seconds now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  if (const char* given = std::getenv("SOURCE_DATE_EPOCH")) {
    const std::string_view text(given);
    long long seconds = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
    const bool is_whole = error == std::errc() && end == text.data() + text.size();
    if (is_whole && !UtcText(static_cast<double>(seconds)).empty()) {
      now = Seconds{std::chrono::seconds(seconds)};
    }
  }
  return DayText(std::chrono::floor<std::chrono::days>(now));
}

}  // namespace sextant
