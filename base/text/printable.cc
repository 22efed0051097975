// SPDX-License-Identifier: Apache-2.0
#include "base/text/printable.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/text/code_point.h"

namespace sextant {
namespace {

std::string PrintableCodePoint(const CodePoint& point, std::string_view bytes) {
  if (point.is_valid && !IsControl(point.value)) return std::string(bytes);
  return point.value < 0x80 || !point.is_valid
             ? fmt::format("\\x{:02x}", static_cast<unsigned>(point.value))
             : fmt::format("\\u{:04x}", static_cast<unsigned>(point.value));
}

bool IsPlainAscii(char c) { return c >= 0x20 && c < 0x7f; }

// Most texts are plain ASCII and stay as they are.
std::string MadePrintable(std::string text, bool keeps_lines) {
  const auto stays = [keeps_lines](char c) {
    return IsPlainAscii(c) || (keeps_lines && c == '\n');
  };
  if (std::all_of(text.begin(), text.end(), stays)) return text;
  std::string printable;
  for (std::string_view rest = text; !rest.empty();) {
    const CodePoint point = FirstCodePoint(rest);
    printable += keeps_lines && rest.front() == '\n'
                     ? std::string("\n")
                     : PrintableCodePoint(point, rest.substr(0, point.bytes));
    rest.remove_prefix(point.bytes);
  }
  return printable;
}

}  // namespace

std::string PrintableLine(std::string text) { return MadePrintable(std::move(text), false); }

std::string PrintableLines(std::string text) { return MadePrintable(std::move(text), true); }

std::string Printable(std::string_view text, std::size_t max_bytes) {
  std::string printable;
  while (!text.empty()) {
    const CodePoint point = FirstCodePoint(text);
    const std::string piece = PrintableCodePoint(point, text.substr(0, point.bytes));
    if (printable.size() + piece.size() > max_bytes) return printable + "...";
    printable += piece;
    text.remove_prefix(point.bytes);
  }
  return printable;
}

std::string Quoted(std::string_view text) {
  std::string ascii;
  for (const char c : text.substr(0, 41)) {
    const auto byte = static_cast<unsigned char>(c);
    ascii += byte > 0x7f ? fmt::format("\\x{:02x}", byte) : std::string(1, c);
  }
  return fmt::format("'{}'", Printable(ascii, 40));
}

}  // namespace sextant
