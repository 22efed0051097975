// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace sextant {

/// The known name with the smallest edit distance (optimal string alignment) from `wrong`, the
/// first of equals; empty if none is close: at most one edit for each three letters of `wrong`, or
/// one of the two names begins with the other.
std::string NearestName(std::string_view wrong, std::span<const std::string> known);

/// "did you mean 'kabsch'?" or, where nothing is close, "known are a, b, c".
std::string SuggestName(std::string_view wrong, std::span<const std::string> known);

}  // namespace sextant
