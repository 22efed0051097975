// SPDX-License-Identifier: Apache-2.0
#include "io/text/metered_text.h"

#include <yaml-cpp/exceptions.h>

#include <algorithm>
#include <array>

namespace sextant {
namespace {

// Upper bounds of what a character adds to the scanner's queue, measured with yaml-cpp 0.7: a token
// takes 107 bytes in its deque, and a scalar in brackets takes two of them beside the one of the
// character that separates it from the next.
constexpr std::size_t kToken = 107;

constexpr std::array<std::size_t, 256> BytesByCharacter() {
  std::array<std::size_t, 256> bytes{};
  for (const char c : std::string_view("[]{},:?!&*#"))
    bytes[static_cast<unsigned char>(c)] = 3 * kToken;
  for (const char c : std::string_view("\"'")) bytes[static_cast<unsigned char>(c)] = kToken;
  return bytes;
}

constexpr std::array<std::size_t, 256> kBytes = BytesByCharacter();

}  // namespace

MeteredText::MeteredText(std::string_view text, std::size_t allowance)
    : text_(text), allowance_(allowance) {}

MeteredText::int_type MeteredText::underflow() {
  constexpr std::size_t kBlock = 2048;
  if (position_ == text_.size()) return traits_type::eof();
  const std::string_view block = text_.substr(position_, kBlock);
  const int first_line = line_;
  for (const char c : block) {
    held_ += kBytes[static_cast<unsigned char>(c)];
    line_ += c == '\n' ? 1 : 0;
  }
  if (held_ > allowance_) {
    YAML::Mark mark;
    mark.line = first_line;
    throw YAML::ParserException(
        mark, "too many values for a text of this size; write long lists one value per line");
  }
  position_ += block.size();
  // The get area is only read.
  char* const begin = const_cast<char*>(block.data());
  setg(begin, begin, begin + block.size());
  return traits_type::to_int_type(*begin);
}

}  // namespace sextant
