// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <streambuf>
#include <string_view>

namespace sextant {

/// Hands a YAML text to yaml-cpp in blocks of 2 KiB, and counts the memory that yaml-cpp's scanner
/// may need for what it has been given. The scanner holds the tokens of a whole collection in
/// brackets, about 320 bytes for each of its brackets, commas and colons, before it reports the
/// first of them; a hostile text of brackets alone would take 250 times its size.
class MeteredText final : public std::streambuf {
 public:
  /// `text` must outlive this object; yaml-cpp's exception ends the reading when the tokens exceed
  /// the bytes that `allowance` returns.
  MeteredText(std::string_view text, std::size_t allowance);

  /// The parser has reported a value: the scanner holds nothing older than this. `allowance` is the
  /// memory that the tokens from here on may take, in bytes.
  void OnEvent(std::size_t allowance) {
    held_ = 0;
    allowance_ = allowance;
  }

 protected:
  int_type underflow() override;

 private:
  std::string_view text_;
  std::size_t position_ = 0;
  std::size_t allowance_;
  std::size_t held_ = 0;  ///< Upper bound of the bytes of the tokens that are not reported yet.
  int line_ = 0;          ///< Lines handed out.
};

}  // namespace sextant
