// SPDX-License-Identifier: Apache-2.0
#include "io/images/image_extent.h"

#include <fmt/core.h>

#include <cstddef>
#include <cstdint>
#include <optional>

#include "io/images/number_at.h"
#include "io/images/stated_size.h"

namespace sextant {
namespace {

using std::string_view_literals::operator""sv;

tl::unexpected<Error> CutOff(std::size_t byte, std::string_view missing) {
  return MakeError(
      ErrorCode::kParse,
      fmt::format("expected an image, but it is cut off: it ends at byte {}, and {} is missing",
                  byte, missing));
}

Expected<void> CheckPixels(std::uint64_t width, std::uint64_t height, std::size_t bytes) {
  constexpr std::uint64_t kUnchecked = std::uint64_t{1} << 24;
  constexpr std::uint64_t kMaxPerByte = 100;
  const std::uint64_t pixels = width * height;  // Both are below 2^32.
  if (pixels <= kUnchecked || pixels / kMaxPerByte <= bytes) return {};
  return MakeError(
      ErrorCode::kParse,
      fmt::format("the image states {} x {} pixels in {} bytes, which would take {} MB; "
                  "expected at most {} pixels, or {} for each byte",
                  width, height, bytes, 3 * pixels >> 20U, kUnchecked, kMaxPerByte));
}

// The byte after the coded data that begins at `at`: a marker other than a restart.
std::size_t EndOfScan(std::string_view bytes, std::size_t at) {
  while (true) {
    at = bytes.find('\xff', at);
    if (at == std::string_view::npos || at + 1 >= bytes.size()) return bytes.size();
    const auto next = static_cast<unsigned char>(bytes[at + 1]);
    const bool is_data = next == 0x00 || (next >= 0xd0 && next <= 0xd7);
    if (!is_data && next != 0xff) return at;
    at += is_data ? 2 : 1;
  }
}

bool StartsFrame(unsigned char marker) {
  return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

Expected<void> CheckJpeg(std::string_view bytes) {
  constexpr std::string_view kEnd = "its end marker";
  constexpr int kMaxScans = 200;
  int scans = 0;
  std::size_t at = 2;
  while (true) {
    // Bytes between segments are skipped, as decoders do.
    at = bytes.find('\xff', at);
    if (at == std::string_view::npos || at + 1 >= bytes.size()) return CutOff(bytes.size(), kEnd);
    const auto marker = static_cast<unsigned char>(bytes[++at]);
    if (marker == 0xff) continue;
    ++at;
    if (marker == 0xd9) return {};
    if (marker <= 0x01 || (marker >= 0xd0 && marker <= 0xd8)) continue;
    const std::size_t length = BigAt(bytes, at, 2).value_or(0);
    if (length < 2 || at + length > bytes.size()) return CutOff(bytes.size(), kEnd);
    if (StartsFrame(marker) && length >= 7) {
      SEXTANT_RETURN_IF_ERROR(
          CheckPixels(*BigAt(bytes, at + 5, 2), *BigAt(bytes, at + 3, 2), bytes.size()));
    }
    at += length;
    if (marker != 0xda) continue;
    if (++scans > kMaxScans) {
      return MakeError(ErrorCode::kParse,
                       fmt::format("the image has more than {} scans, each of which is a pass over "
                                   "all pixels; expected an image as a camera writes it",
                                   kMaxScans));
    }
    at = EndOfScan(bytes, at);
  }
}

Expected<void> CheckPng(std::string_view bytes) {
  constexpr std::size_t kSignature = 8;
  constexpr std::size_t kAround = 12;  // Length, type and checksum of a chunk.
  for (std::size_t at = kSignature; at + kAround <= bytes.size();) {
    const std::size_t length = *BigAt(bytes, at, 4);
    const std::string_view type = bytes.substr(at + 4, 4);
    if (length > bytes.size() - at - kAround) break;
    if (type == "IEND") return {};
    if (type == "IHDR" && length >= 8) {
      SEXTANT_RETURN_IF_ERROR(
          CheckPixels(*BigAt(bytes, at + 8, 4), *BigAt(bytes, at + 12, 4), bytes.size()));
    }
    at += kAround + length;
  }
  return CutOff(bytes.size(), "its end (the chunk IEND)");
}

}  // namespace

Expected<void> CheckImageExtent(std::string_view bytes) {
  if (bytes.starts_with("\xff\xd8\xff"sv)) return CheckJpeg(bytes);
  if (bytes.starts_with("\x89PNG"sv)) return CheckPng(bytes);
  if (const std::optional<StatedSize> size = FindStatedSize(bytes)) {
    return CheckPixels(size->width, size->height, bytes.size());
  }
  return MakeError(ErrorCode::kParse,
                   "expected an image: PNG, JPEG, BMP, PGM, PPM, TIFF or WebP; convert others");
}

}  // namespace sextant
