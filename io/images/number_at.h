// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace sextant {

/// The number of `size` bytes, at most 4, at byte `at`, the lowest byte first; none beyond the end.
inline std::optional<std::uint32_t> LittleAt(std::string_view bytes, std::size_t at,
                                             std::size_t size) {
  if (at > bytes.size() || bytes.size() - at < size) return {};
  std::uint32_t number = 0;
  for (std::size_t i = size; i-- > 0;) {
    number = number << 8U | static_cast<unsigned char>(bytes[at + i]);
  }
  return number;
}

/// The same with the highest byte first.
inline std::optional<std::uint32_t> BigAt(std::string_view bytes, std::size_t at,
                                          std::size_t size) {
  if (at > bytes.size() || bytes.size() - at < size) return {};
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < size; ++i) {
    number = number << 8U | static_cast<unsigned char>(bytes[at + i]);
  }
  return number;
}

}  // namespace sextant
