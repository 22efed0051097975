// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace sextant {

/// More levels than any JSON that this program writes.
inline constexpr int kMaxJsonDepth = 16;

/// Whether the brackets of a JSON text nest deeper than kMaxJsonDepth. A parser takes about 70
/// bytes for each level, and at most 40 bytes for each byte of a text that this admits. Time is
/// linear.
bool IsJsonTooDeep(std::string_view text);

}  // namespace sextant
