// SPDX-License-Identifier: Apache-2.0
#include "io/output/file_mark.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <utility>

#include "base/descriptor.h"

namespace sextant {
namespace {

constexpr const char* kAttribute = "user.sextant";

std::string MarkOf(const struct stat& status) {
  return fmt::format("{} bytes, {}.{:09} s", status.st_size, status.st_mtim.tv_sec,
                     status.st_mtim.tv_nsec);
}

// Not open if it is no regular file, or cannot be read.
Descriptor OpenRegular(int folder, const std::string& name) {
  Descriptor file(openat(folder, name.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  struct stat status {};
  const bool is_regular =
      file.is_open() && fstat(file.get(), &status) == 0 && S_ISREG(status.st_mode);
  return is_regular ? std::move(file) : Descriptor();
}

}  // namespace

void MarkAsWritten(int fd) {
  struct stat status {};
  if (fstat(fd, &status) != 0) return;
  const std::string mark = MarkOf(status);
  // Without the mark, --overwrite is needed the next time.
  const int ignored = fsetxattr(fd, kAttribute, mark.data(), mark.size(), 0);
  static_cast<void>(ignored);
}

FileOrigin OriginOf(int folder, const std::string& name) {
  const Descriptor file = OpenRegular(folder, name);
  struct stat status {};
  if (!file.is_open() || fstat(file.get(), &status) != 0) return FileOrigin::kUnmarked;
  if (status.st_size == 0) return FileOrigin::kSextant;
  std::array<char, 100> mark{};
  const ssize_t size = fgetxattr(file.get(), kAttribute, mark.data(), mark.size());
  if (size < 0) return errno == ENOTSUP ? FileOrigin::kUnknown : FileOrigin::kUnmarked;
  const std::string_view found(mark.data(), static_cast<std::size_t>(size));
  return found == MarkOf(status) ? FileOrigin::kSextant : FileOrigin::kChanged;
}

bool StatesOrigin(int folder, const std::string& name, std::string_view text) {
  if (OriginOf(folder, name) == FileOrigin::kChanged) return false;
  const Descriptor file = OpenRegular(folder, name);
  std::array<char, 4096> begin{};
  const ssize_t size = file.is_open() ? read(file.get(), begin.data(), begin.size()) : 0;
  return size > 0 && std::string_view(begin.data(), static_cast<std::size_t>(size)).find(text) !=
                         std::string_view::npos;
}

}  // namespace sextant
