// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace sextant {

struct StatedSize {
  std::uint64_t width = 0;
  std::uint64_t height = 0;
};

/// The size in pixels that the header of a BMP, PBM/PGM/PPM, TIFF (not BigTIFF) or WebP states; of
/// a TIFF in tiles, that of a tile if it has more pixels than the image. Each number is below 2^32.
/// None for another format, and for a header that is cut off. Time is linear in the bytes; no
/// memory.
std::optional<StatedSize> FindStatedSize(std::string_view bytes);

}  // namespace sextant
