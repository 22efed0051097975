// SPDX-License-Identifier: Apache-2.0
#include "io/text/text_file.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "base/call_files.h"
#include "base/descriptor.h"
#include "base/text/path_text.h"
#include "io/text/git_lfs.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

tl::unexpected<Error> ReadError(const std::filesystem::path& path, const std::string& reason,
                                ErrorCode code = ErrorCode::kIo) {
  return MakeError(code, fmt::format("cannot read '{}': {}", PathText(path), reason));
}

tl::unexpected<Error> SystemError(const std::filesystem::path& path) {
  return ReadError(path, std::generic_category().message(errno));
}

}  // namespace

Expected<void> CheckInput(const std::filesystem::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return {};
  const std::string why = NoteInput(status);
  if (!why.empty()) return ReadError(path, why, ErrorCode::kInvalidOption);
  return {};
}

Expected<std::string> ReadTextFile(const std::filesystem::path& path) {
  // Without O_NONBLOCK, opening a pipe without a writer would block.
  const Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status {};
  if (file.get() < 0 || fstat(file.get(), &status) != 0) return SystemError(path);
  if (S_ISDIR(status.st_mode)) return ReadError(path, "it is a folder, expected a file");
  if (!S_ISREG(status.st_mode)) return ReadError(path, "it is not a regular file");
  if (const std::string why = NoteInput(status); !why.empty()) {
    return ReadError(path, why, ErrorCode::kInvalidOption);
  }
  if (static_cast<std::size_t>(status.st_size) > kMaxTextBytes) {
    return ReadError(path, fmt::format("it has {} bytes, expected at most {}; is it a text file?",
                                       status.st_size, kMaxTextBytes));
  }
  std::string text(static_cast<std::size_t>(status.st_size), '\0');
  std::size_t size = 0;
  while (size < text.size()) {
    const ssize_t got = read(file.get(), text.data() + size, text.size() - size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return SystemError(path);
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
  }
  text.resize(size);
  if (const Expected<void> whole = RefuseGitLfsPointer(text); !whole) {
    return ReadError(path, whole.error().message, whole.error().code);
  }
  return text;
}

}  // namespace sextant
