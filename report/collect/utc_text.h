// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

namespace sextant {

/// "2019-05-04 10:11:12 UTC".
std::string UtcText(std::chrono::sys_seconds time);
/// The same for other programs (ISO 8601): "2019-05-04T10:11:12Z".
std::string UtcIsoText(std::chrono::sys_seconds time);

/// UtcText of the seconds since 1970; empty where they are no time of a
/// recording (before 1980: clocks that start at zero).
std::string UtcText(double seconds);

/// "2026-11-30": the day of now or, where the environment has it, of SOURCE_DATE_EPOCH.
std::string TodayText();

}  // namespace sextant
