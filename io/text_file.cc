// SPDX-License-Identifier: Apache-2.0
#include "io/text_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "io/number_text.h"

namespace sextant {
namespace {

// Closes on every way out; Close() where its result matters.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() { Close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int get() const { return fd_; }
  bool Close() {
    const int fd = fd_;
    fd_ = -1;
    return fd < 0 || close(fd) == 0;
  }

 private:
  int fd_;
};

tl::unexpected<Error> IoError(const char* verb, const std::filesystem::path& path,
                              const std::string& reason) {
  return MakeError(ErrorCode::kIo,
                   fmt::format("cannot {} '{}': {}", verb, Printable(path.string(), 300), reason));
}

tl::unexpected<Error> SystemError(const char* verb, const std::filesystem::path& path) {
  return IoError(verb, path, std::generic_category().message(errno));
}

bool WriteAll(int fd, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = write(fd, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

Expected<void> WriteDirectly(const std::filesystem::path& path, std::string_view text) {
  Descriptor file(open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (file.get() < 0 || !WriteAll(file.get(), text) || !file.Close()) {
    return SystemError("write", path);
  }
  return {};
}

}  // namespace

Expected<std::string> ReadTextFile(const std::filesystem::path& path) {
  // Without O_NONBLOCK a pipe that nobody writes would hang here.
  const Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status {};
  if (file.get() < 0 || fstat(file.get(), &status) != 0) return SystemError("read", path);
  if (S_ISDIR(status.st_mode)) return IoError("read", path, "it is a folder, expected a file");
  if (!S_ISREG(status.st_mode)) return IoError("read", path, "it is not a regular file");
  if (static_cast<std::size_t>(status.st_size) > kMaxTextBytes) {
    return IoError("read", path,
                   fmt::format("it has {} bytes, expected at most {}; is it a text file?",
                               status.st_size, kMaxTextBytes));
  }
  std::string text(static_cast<std::size_t>(status.st_size), '\0');
  std::size_t size = 0;
  while (size < text.size()) {
    const ssize_t got = read(file.get(), text.data() + size, text.size() - size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return SystemError("read", path);
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
  }
  text.resize(size);
  return text;
}

Expected<void> WriteFileAtomically(const std::filesystem::path& path, std::string_view text) {
  struct stat status {};
  const bool exists = stat(path.c_str(), &status) == 0;
  if (exists && S_ISDIR(status.st_mode)) return IoError("write", path, "it is a folder");
  // Renaming over a device would replace it.
  if (exists && !S_ISREG(status.st_mode)) return WriteDirectly(path, text);

  std::error_code ignored;
  const std::filesystem::path target = exists ? std::filesystem::canonical(path, ignored) : path;
  const std::filesystem::path temporary =
      target.parent_path() /
      fmt::format(".{}.{}.tmp", target.filename().string().substr(0, 200), getpid());
  Descriptor file(open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (file.get() < 0) return SystemError("write", path);
  const bool ok = (!exists || fchmod(file.get(), status.st_mode & 07777U) == 0) &&
                  WriteAll(file.get(), text) && fsync(file.get()) == 0 && file.Close() &&
                  rename(temporary.c_str(), target.c_str()) == 0;
  if (ok) return {};
  const int reason = errno;
  unlink(temporary.c_str());
  errno = reason;
  return SystemError("write", path);
}

}  // namespace sextant
