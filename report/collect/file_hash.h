// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace sextant {

/// SHA-256 of a regular file as sha256sum prints it; none if it cannot be read. It is remembered
/// while the process runs, and a file whose size and time of change are the same is not read again:
/// `sextant capture` asks after each scan. Time is linear in the file's size, memory is constant
/// for each path. Thread-safe.
std::optional<std::string> HashOfFile(const std::filesystem::path& path);

/// SHA-256 of the bytes, 64 hexadecimal digits.
std::string HashOfBytes(std::string_view bytes);

}  // namespace sextant
