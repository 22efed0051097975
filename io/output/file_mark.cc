// SPDX-License-Identifier: Apache-2.0
#include "io/output/file_mark.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <sys/xattr.h>

#include <array>

#include "base/descriptor.h"

namespace sextant {
namespace {

constexpr const char* kAttribute = "user.sextant";

std::string MarkOf(const struct stat& status) {
  return fmt::format("{} bytes, {}.{:09} s", status.st_size, status.st_mtim.tv_sec,
                     status.st_mtim.tv_nsec);
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

bool IsWrittenBySextant(int folder, const std::string& name) {
  const Descriptor file(
      openat(folder, name.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  struct stat status {};
  if (!file.is_open() || fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode)) return false;
  if (status.st_size == 0) return true;
  std::array<char, 100> mark{};
  const ssize_t size = fgetxattr(file.get(), kAttribute, mark.data(), mark.size());
  return size > 0 &&
         std::string_view(mark.data(), static_cast<std::size_t>(size)) == MarkOf(status);
}

}  // namespace sextant
