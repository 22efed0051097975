// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

#include "io/bag/messages.h"

namespace sextant {

/// The description of a message's type in a ROS 1 bag.
struct Ros1Type {
  std::string_view name;
  std::string_view md5;  ///< MD5 of the definition without comments.
  std::string_view definition;
};

extern const Ros1Type kPointCloud2Type;
extern const Ros1Type kImageType;
extern const Ros1Type kCompressedImageType;
extern const Ros1Type kCameraInfoType;

/// Appends the bytes of a number, little endian.
template <class Number>
void AppendNumber(std::string& out, Number value) {
  static_assert(std::endian::native == std::endian::little);
  const auto raw = std::bit_cast<std::array<char, sizeof(Number)>>(value);
  out.append(raw.data(), raw.size());
}

/// Appends the length (4 bytes) and the bytes.
void AppendCounted(std::string& out, std::string_view bytes);

/// Serialises a message as ROS 1 does. Requires a stamp from 0 to 2^32 s.
std::string Ros1Message(const CloudMessage& message);
std::string Ros1Message(const ImageMessage& message);
std::string Ros1Message(const EncodedImageMessage& message);
std::string Ros1Message(const CameraInfoMessage& message);

}  // namespace sextant
