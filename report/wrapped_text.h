// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace sextant {

/// Characters of a line of text for people.
inline constexpr std::size_t kTextWidth = 100;

/// The text as one paragraph, broken at blanks into lines of at most `width` characters; a longer
/// word has a line of its own. Ends with a newline. O(n).
std::string Wrapped(const std::string& text, std::size_t width);

/// Each line of more than kTextWidth characters is broken at blanks, with a hanging indent of two
/// more than its own where it has one; other lines stay as they are. O(n).
std::string Narrow(const std::string& text);

}  // namespace sextant
