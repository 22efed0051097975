// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace sextant {

/// The known name that is fewest edits (Levenshtein) away from `wrong`; the first of equals.
/// Empty where nothing is known.
std::string NearestName(std::string_view wrong, std::span<const std::string> known);

/// "did you mean 'kabsch'?" or, where nothing is close, "known are a, b, c".
std::string SuggestName(std::string_view wrong, std::span<const std::string> known);

}  // namespace sextant
