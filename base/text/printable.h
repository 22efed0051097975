// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace sextant {

/// The text on one line that no terminal obeys: control characters (IsControl) and bytes that are
/// not UTF-8 as \x1b or \u202e. Everything else, letters of any language too, stays as it is.
std::string PrintableLine(std::string text);

/// As PrintableLine, but line feeds stay: for our own texts of several lines with names of others
/// in them.
std::string PrintableLines(std::string text);

/// PrintableLine, cut to `max_bytes` bytes and then ended with "...".
std::string Printable(std::string_view text, std::size_t max_bytes);

/// The text in single quotes on one line: cut to 40 bytes, everything but ASCII as \xNN.
std::string Quoted(std::string_view text);

}  // namespace sextant
