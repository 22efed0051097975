// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace sextant {

/// SHA-256 of a regular file as sha256sum prints it; none if it cannot be read. Time is linear in
/// its size, memory is constant.
std::optional<std::string> HashOfFile(const std::filesystem::path& path);

/// SHA-256 of the bytes, 64 hexadecimal digits.
std::string HashOfBytes(std::string_view bytes);

}  // namespace sextant
