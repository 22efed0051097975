// SPDX-License-Identifier: Apache-2.0
#include "base/text/code_point.h"

#include <array>

namespace sextant {
namespace {

struct Form {
  unsigned char mask;  // The bits of the first byte that state the length.
  unsigned char mark;
  char32_t smallest;  // Smaller values have a shorter form.
};

// Forms of 2, 3 and 4 bytes.
constexpr std::array<Form, 3> kForms = {
    {{0xe0, 0xc0, 0x80}, {0xf0, 0xe0, 0x800}, {0xf8, 0xf0, 0x10000}}};

constexpr bool IsWithin(char32_t value, char32_t first, char32_t last) {
  return value >= first && value <= last;
}

}  // namespace

CodePoint FirstCodePoint(std::string_view text) {
  const auto byte = [text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return {.value = first, .bytes = 1, .is_valid = true};
  const CodePoint invalid{.value = first, .bytes = 1, .is_valid = false};
  for (std::size_t k = 0; k < kForms.size(); ++k) {
    const Form& form = kForms[k];
    if ((first & form.mask) != form.mark) continue;
    const std::size_t bytes = k + 2;
    if (text.size() < bytes) return invalid;
    char32_t value = first & static_cast<unsigned char>(~form.mask);
    for (std::size_t i = 1; i < bytes; ++i) {
      if ((byte(i) & 0xc0U) != 0x80) return invalid;
      value = (value << 6U) | (byte(i) & 0x3fU);
    }
    if (value < form.smallest || IsWithin(value, 0xd800, 0xdfff) || value > 0x10ffff) {
      return invalid;
    }
    return {.value = value, .bytes = bytes, .is_valid = true};
  }
  return invalid;
}

bool IsControl(char32_t value) {
  return value < 0x20 || IsWithin(value, 0x7f, 0x9f) || IsWithin(value, 0x2028, 0x202e) ||
         IsWithin(value, 0x2066, 0x2069) || IsWithin(value, 0xfffe, 0xffff);
}

bool IsPlainLine(std::string_view text) {
  while (!text.empty()) {
    const CodePoint first = FirstCodePoint(text);
    if (!first.is_valid || IsControl(first.value)) return false;
    text.remove_prefix(first.bytes);
  }
  return true;
}

}  // namespace sextant
