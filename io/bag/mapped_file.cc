// SPDX-License-Identifier: Apache-2.0
#include "io/bag/mapped_file.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "base/call_files.h"
#include "base/text/path_text.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

tl::unexpected<Error> ReadError(const std::filesystem::path& path, const std::string& reason) {
  return MakeError(ErrorCode::kIo, fmt::format("cannot read '{}': {}", PathText(path), reason));
}

}  // namespace

Expected<std::shared_ptr<const MappedFile>> MappedFile::Open(const std::filesystem::path& path) {
  // Without O_NONBLOCK, opening a pipe without a writer would block.
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return ReadError(path, std::generic_category().message(errno));
  struct stat status {};
  const bool is_file = fstat(fd, &status) == 0 && S_ISREG(status.st_mode);
  const std::string refusal = is_file ? NoteInput(status) : "";
  const auto size = static_cast<std::size_t>(is_file && refusal.empty() ? status.st_size : 0);
  void* const data = size > 0 ? mmap(nullptr, size, PROT_READ, MAP_PRIVATE, fd, 0) : nullptr;
  const int reason = errno;
  close(fd);
  if (!is_file) return ReadError(path, "it is not a regular file");
  if (!refusal.empty()) return ReadError(path, refusal);
  if (data == MAP_FAILED) return ReadError(path, std::generic_category().message(reason));
  return std::shared_ptr<const MappedFile>(new MappedFile(static_cast<const char*>(data), size));
}

MappedFile::~MappedFile() {
  if (size_ > 0) munmap(const_cast<char*>(data_), size_);
}

}  // namespace sextant
