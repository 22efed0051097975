// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "base/error.h"

namespace sextant {

/// Larger files are refused. The limit admits four million pairs and protects the memory when a
/// large scan is given by mistake.
inline constexpr std::size_t kMaxTextBytes = std::size_t{256} << 20;

/// The bytes of a regular file; time and memory are its size. Error: kIo, with the path and the
/// system's reason.
Expected<std::string> ReadTextFile(const std::filesystem::path& path);

/// Writes the whole file or nothing: a temporary file in the same folder is flushed to the disk and
/// renamed to `path`. Keeps the permissions of a file that it replaces and follows links; devices
/// and pipes are written directly. Error: kIo; no partial file remains.
Expected<void> WriteFileAtomically(const std::filesystem::path& path, std::string_view text);

/// As WriteFileAtomically, for content that does not fit in memory: the file appears when Commit()
/// returns; without Commit() nothing remains of it. Errors: kIo.
class AtomicFileWriter {
 public:
  static Expected<AtomicFileWriter> Open(const std::filesystem::path& path);
  ~AtomicFileWriter();
  AtomicFileWriter(AtomicFileWriter&& other) noexcept;
  AtomicFileWriter& operator=(AtomicFileWriter&&) = delete;

  Expected<void> Append(std::string_view text);
  Expected<void> Commit();

 private:
  explicit AtomicFileWriter(std::filesystem::path path) : path_(std::move(path)) {}

  std::filesystem::path path_;
  std::filesystem::path target_;     ///< `path_` with links resolved.
  std::filesystem::path temporary_;  ///< Empty for devices and pipes.
  std::optional<mode_t> mode_;       ///< Permissions of the file that is replaced.
  int fd_ = -1;
};

/// Reads the file and returns parse(content, path); error messages name the path as given.
template <class Parse>
std::invoke_result_t<Parse, std::string_view, std::string> ReadWith(
    const std::filesystem::path& path, Parse parse) {
  SEXTANT_ASSIGN_OR_RETURN(const std::string text, ReadTextFile(path));
  return parse(std::string_view{text}, path.string());
}

}  // namespace sextant
