// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace sextant {

/// Checksum that detects damaged row files; not cryptographic. Requires a multiple of 8 bytes.
inline std::uint64_t RowChecksum(std::string_view bytes) {
  std::uint64_t state = 0x9E3779B97F4A7C15ULL;
  for (std::size_t i = 0; i + 8 <= bytes.size(); i += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + i, 8);
    state = (std::rotl(state, 29) ^ word) * 0xD6E8FEB86659FD93ULL;
  }
  return state ^ (state >> 32U);
}

inline constexpr std::string_view kRowFileMark = "sxtrows1";
inline constexpr std::string_view kRowBlockMark = "sxtblock";

/// Bytes of a block's mark, number and row count; its rows and an 8-byte checksum follow.
inline constexpr std::uint64_t kRowBlockHead = 24;

inline std::uint64_t BytesOfBlock(std::uint64_t rows, std::uint64_t columns) {
  return kRowBlockHead + 8 * rows * (1 + columns) + 8;
}

}  // namespace sextant
