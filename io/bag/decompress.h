// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "base/error.h"

namespace sextant {

enum class Compression { kNone, kBz2, kLz4, kZstd };

/// "none", "bz2", "lz4" or "zstd"; "" is none. Error: kParse, which lists these.
Expected<Compression> CompressionNamed(std::string_view name);

/// The `size` bytes that were compressed (lz4: the frame format). The memory taken grows with what
/// is found, not with what `size` promises, and over 64 MiB no more than 256 times the compressed
/// bytes are accepted (zstd may take its window besides, 128 MiB at most). Error: kParse, which
/// does not name the file.
Expected<std::string> Decompress(Compression compression, std::string_view bytes, std::size_t size);

/// The same for one zstd frame that states its own size.
Expected<std::string> DecompressZstdFrame(std::string_view bytes);

/// The reverse, for none, bz2 and lz4 (independent blocks and a checksum, as ROS 1 demands).
std::string Compress(Compression compression, std::string_view bytes);

}  // namespace sextant
