// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <type_traits>

#include "base/error.h"

namespace sextant {

/// Larger files are refused. The limit admits four million pairs and protects the memory when a
/// large scan is given by mistake.
inline constexpr std::size_t kMaxTextBytes = std::size_t{256} << 20;

/// The bytes of a regular file; time and memory are its size. Errors: kIo, with the path and the
/// system's reason; kInvalidOption for a file that is also an output of the call
/// (base/call_files.h); kParse for a Git LFS pointer (io/text/git_lfs.h).
Expected<std::string> ReadTextFile(const std::filesystem::path& path);

/// Refuses an input that is also an output of the call, without reading it. Whether it can be read
/// is seen later. Error: kInvalidOption.
Expected<void> CheckInput(const std::filesystem::path& path);

/// Reads the file and returns parse(content, path); error messages name the path as given.
template <class Parse>
std::invoke_result_t<Parse, std::string_view, std::string> ReadWith(
    const std::filesystem::path& path, Parse parse) {
  SEXTANT_ASSIGN_OR_RETURN(const std::string text, ReadTextFile(path));
  return parse(std::string_view{text}, path.string());
}

}  // namespace sextant
