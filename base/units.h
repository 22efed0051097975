// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

namespace sextant {

inline constexpr double kRadPerDeg = std::numbers::pi / 180.0;
inline constexpr double kDegPerRad = 180.0 / std::numbers::pi;
inline constexpr double kMmPerM = 1e3;

}  // namespace sextant
