// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

namespace sextant {

/// A Unicode code point at the beginning of a text in UTF-8, or a byte that is none.
struct CodePoint {
  char32_t value = 0;     ///< The byte itself if it is not valid UTF-8.
  std::size_t bytes = 1;  ///< Its length in the text.
  bool is_valid = false;
};

/// Requires a text that is not empty. Refuses overlong forms, surrogates and values above U+10FFFF
/// (RFC 3629).
CodePoint FirstCodePoint(std::string_view text);

/// Whether the code point could control a terminal, end a line, reorder the text around it, or is
/// forbidden in XML: C0, DEL, C1, U+2028 and U+2029, the bidirectional embeddings, overrides and
/// isolates, U+FFFE and U+FFFF.
bool IsControl(char32_t value);

/// Whether the text is valid UTF-8 without control characters.
bool IsPlainLine(std::string_view text);

}  // namespace sextant
