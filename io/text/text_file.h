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

/// Larger files are refused: four million pairs fit, a scan given by mistake does not fill memory.
inline constexpr std::size_t kMaxTextBytes = std::size_t{256} << 20;

/// The bytes of a regular file. Error: kIo, with the path and the system's reason.
Expected<std::string> ReadTextFile(const std::filesystem::path& path);

/// Writes the file whole or not at all: a temporary in the same folder, flushed to the disk, then
/// renamed over `path`. Keeps the permissions of a file that it replaces and follows links;
/// devices and pipes are written directly. Error: kIo; nothing is left behind then.
Expected<void> WriteFileAtomically(const std::filesystem::path& path, std::string_view text);

/// As WriteFileAtomically, for what is too large to stand in memory: the file is there once
/// Commit() has returned, and nothing of it is left where that is not reached. Errors: kIo.
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
  std::filesystem::path target_;     ///< Of links.
  std::filesystem::path temporary_;  ///< Empty for devices and pipes.
  std::optional<mode_t> mode_;       ///< Of the file that is replaced.
  int fd_ = -1;
};

/// parse(text, name) of the file's content; the path as given names it in messages.
template <class Parse>
std::invoke_result_t<Parse, std::string_view, std::string> ReadWith(
    const std::filesystem::path& path, Parse parse) {
  SEXTANT_ASSIGN_OR_RETURN(const std::string text, ReadTextFile(path));
  return parse(std::string_view{text}, path.string());
}

}  // namespace sextant
