// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstring>
#include <string_view>

namespace sextant {

/// Reads numbers and byte strings from a buffer one after the other, never past its end. After an
/// attempt to read past the end, ok() is false and every result is zero or empty.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes, bool big_endian = false)
      : bytes_(bytes), swap_(big_endian != (std::endian::native == std::endian::big)) {}

  bool ok() const { return ok_; }
  std::size_t position() const { return position_; }
  std::size_t bytes_left() const { return bytes_.size() - position_; }

  std::string_view Bytes(std::size_t count) {
    if (!ok_ || count > bytes_left()) {
      ok_ = false;
      return {};
    }
    const std::string_view taken = bytes_.substr(position_, count);
    position_ += count;
    return taken;
  }

  template <class Number>
  Number Take() {
    std::array<char, sizeof(Number)> raw{};
    const std::string_view taken = Bytes(raw.size());
    if (taken.empty()) return Number{};
    std::memcpy(raw.data(), taken.data(), raw.size());
    if (swap_) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<Number>(raw);
  }

  /// A byte string preceded by its length, which has the type Length.
  template <std::unsigned_integral Length>
  std::string_view Counted() {
    return Bytes(Take<Length>());
  }

 private:
  std::string_view bytes_;
  bool swap_;
  bool ok_ = true;
  std::size_t position_ = 0;
};

}  // namespace sextant
