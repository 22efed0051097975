// SPDX-License-Identifier: Apache-2.0
#include "io/images/stated_size.h"

#include <algorithm>
#include <cstddef>

#include "io/images/number_at.h"

namespace sextant {
namespace {

using std::string_view_literals::operator""sv;

std::optional<StatedSize> SizeOfBmp(std::string_view bytes) {
  const auto header = LittleAt(bytes, 14, 4);
  const std::size_t size = header == 12U ? 2 : 4;  // OS/2's header has numbers of 16 bits.
  const auto width = LittleAt(bytes, 18, size);
  const auto height = LittleAt(bytes, 18 + size, size);
  if (!width || !height) return {};
  // Rows from top to bottom have a negative height.
  const bool is_negative = size == 4 && (*height >> 31U) != 0;
  return StatedSize{*width, is_negative ? 0U - *height : *height};
}

// A decimal number after blanks and comments; moves `at` behind it. None above 2^32.
std::optional<std::uint64_t> DecimalAt(std::string_view bytes, std::size_t& at) {
  while (at < bytes.size() && (bytes[at] == '#' || " \t\n\v\f\r"sv.find(bytes[at]) != bytes.npos)) {
    at = bytes[at] == '#' ? std::min(bytes.find_first_of("\n\r", at), bytes.size()) : at + 1;
  }
  const std::size_t begin = at;
  std::uint64_t number = 0;
  for (; at < bytes.size() && bytes[at] >= '0' && bytes[at] <= '9'; ++at) {
    number = 10 * number + static_cast<std::uint64_t>(bytes[at] - '0');
    if (number >> 32U != 0) return {};
  }
  if (at == begin) return {};
  return number;
}

std::optional<StatedSize> SizeOfPnm(std::string_view bytes) {
  std::size_t at = 2;
  const auto width = DecimalAt(bytes, at);
  const auto height = DecimalAt(bytes, at);
  if (!width || !height) return {};
  return StatedSize{*width, *height};
}

std::optional<StatedSize> SizeOfTiff(std::string_view bytes) {
  const auto number_at = bytes[0] == 'I' ? LittleAt : BigAt;
  const auto directory = number_at(bytes, 4, 4);
  const auto entries = directory ? number_at(bytes, *directory, 2) : directory;
  if (!entries) return {};
  constexpr std::uint32_t kWidth = 256;
  constexpr std::uint32_t kHeight = 257;
  constexpr std::uint32_t kTileWidth = 322;
  constexpr std::uint32_t kTileHeight = 323;
  constexpr std::uint32_t kShort = 3;
  StatedSize image;
  StatedSize tile;
  for (std::size_t i = 0; i < *entries; ++i) {
    const std::size_t at = *directory + 2 + 12 * i;
    const auto tag = number_at(bytes, at, 2);
    const auto type = number_at(bytes, at + 2, 2);
    const auto value = number_at(bytes, at + 8, type == kShort ? 2 : 4);
    if (!tag || !type || !value) return {};
    if (tag == kWidth) image.width = std::max<std::uint64_t>(image.width, *value);
    if (tag == kHeight) image.height = std::max<std::uint64_t>(image.height, *value);
    if (tag == kTileWidth) tile.width = std::max<std::uint64_t>(tile.width, *value);
    if (tag == kTileHeight) tile.height = std::max<std::uint64_t>(tile.height, *value);
  }
  return tile.width * tile.height > image.width * image.height ? tile : image;
}

std::optional<StatedSize> SizeOfWebp(std::string_view bytes) {
  const std::string_view chunk = bytes.substr(12, 4);
  if (chunk == "VP8X") {
    const auto width = LittleAt(bytes, 24, 3);
    const auto height = LittleAt(bytes, 27, 3);
    if (!width || !height) return {};
    return StatedSize{*width + 1U, *height + 1U};
  }
  if (chunk == "VP8L") {
    const auto packed = LittleAt(bytes, 21, 4);
    if (!packed) return {};
    return StatedSize{(*packed & 0x3fffU) + 1U, (*packed >> 14U & 0x3fffU) + 1U};
  }
  const auto width = LittleAt(bytes, 26, 2);
  const auto height = LittleAt(bytes, 28, 2);
  if (chunk != "VP8 " || !width || !height) return {};
  return StatedSize{*width & 0x3fffU, *height & 0x3fffU};
}

}  // namespace

std::optional<StatedSize> FindStatedSize(std::string_view bytes) {
  if (bytes.starts_with("BM")) return SizeOfBmp(bytes);
  if (bytes.starts_with("II\x2a\0"sv) || bytes.starts_with("MM\0\x2a"sv)) return SizeOfTiff(bytes);
  if (bytes.size() >= 16 && bytes.starts_with("RIFF") && bytes.substr(8, 4) == "WEBP") {
    return SizeOfWebp(bytes);
  }
  const bool is_pnm = bytes.size() > 2 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '6';
  return is_pnm ? SizeOfPnm(bytes) : std::nullopt;
}

}  // namespace sextant
