// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace sextant {

/// Points within 1e-5 of their length of a line leave the turn about it to rounding.
inline constexpr double kMinLineVariance = 1e-10;

/// Doubles carry 1e-8 m at this distance.
inline constexpr double kMaxDistance_m = 1e8;

}  // namespace sextant
