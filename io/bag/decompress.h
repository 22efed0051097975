// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "base/error.h"

namespace sextant {

enum class Compression { kNone, kBz2, kLz4, kZstd };

/// "none", "bz2", "lz4" or "zstd"; "" is none. Error: kParse, which lists the names.
Expected<Compression> CompressionNamed(std::string_view name);

/// Decompresses `bytes` to the stated `size` (lz4: the frame format). Memory grows with the bytes
/// produced, not with `size`; above 64 MiB, at most 256 times the compressed bytes are accepted.
/// zstd may allocate a window of at most 128 MiB besides. Error: kParse, which does not name the
/// file.
Expected<std::string> Decompress(Compression compression, std::string_view bytes, std::size_t size);

/// The beginning of what `bytes`, themselves the beginning of a stream, decompress to: all whole
/// blocks of the format, perhaps none.
std::string DecompressBegun(Compression compression, std::string_view bytes, std::size_t size);

/// As Decompress, for a zstd frame that states its own size.
Expected<std::string> DecompressZstdFrame(std::string_view bytes);

/// Compresses by none, bz2 or lz4 (independent blocks and a checksum, as ROS 1 requires).
std::string Compress(Compression compression, std::string_view bytes);

}  // namespace sextant
