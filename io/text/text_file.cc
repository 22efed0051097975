// SPDX-License-Identifier: Apache-2.0
#include "io/text/text_file.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "io/text/number_text.h"

namespace sextant {
namespace {

// Closes the file when it goes out of scope.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int get() const { return fd_; }

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

}  // namespace

Expected<std::string> ReadTextFile(const std::filesystem::path& path) {
  // Without O_NONBLOCK, opening a pipe without a writer would block.
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

AtomicFileWriter::~AtomicFileWriter() {
  if (fd_ >= 0) close(fd_);
  if (!temporary_.empty()) unlink(temporary_.c_str());
}

AtomicFileWriter::AtomicFileWriter(AtomicFileWriter&& other) noexcept
    : path_(std::move(other.path_)),
      target_(std::move(other.target_)),
      temporary_(std::exchange(other.temporary_, {})),
      mode_(other.mode_),
      fd_(std::exchange(other.fd_, -1)) {}

Expected<AtomicFileWriter> AtomicFileWriter::Open(const std::filesystem::path& path) {
  AtomicFileWriter writer(path);
  struct stat status {};
  const bool exists = stat(path.c_str(), &status) == 0;
  if (exists && S_ISDIR(status.st_mode)) return IoError("write", path, "it is a folder");
  // Renaming over a device would replace it.
  if (exists && !S_ISREG(status.st_mode)) {
    writer.fd_ = open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (writer.fd_ < 0) return SystemError("write", path);
    return writer;
  }
  std::error_code ignored;
  writer.target_ = exists ? std::filesystem::canonical(path, ignored) : path;
  if (exists) writer.mode_ = status.st_mode & 07777U;
  const std::filesystem::path temporary =
      writer.target_.parent_path() /
      fmt::format(".{}.{}.tmp", writer.target_.filename().string().substr(0, 200), getpid());
  writer.fd_ = open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (writer.fd_ < 0) return SystemError("write", path);
  writer.temporary_ = temporary;
  return writer;
}

Expected<void> AtomicFileWriter::Append(std::string_view text) {
  if (!WriteAll(fd_, text)) return SystemError("write", path_);
  return {};
}

Expected<void> AtomicFileWriter::Commit() {
  const auto close_once = [this] { return close(std::exchange(fd_, -1)) == 0; };
  if (temporary_.empty()) {
    if (!close_once()) return SystemError("write", path_);
    return {};
  }
  const bool ok = (!mode_ || fchmod(fd_, *mode_) == 0) && fsync(fd_) == 0 && close_once() &&
                  rename(temporary_.c_str(), target_.c_str()) == 0;
  if (!ok) return SystemError("write", path_);
  temporary_.clear();
  return {};
}

Expected<void> WriteFileAtomically(const std::filesystem::path& path, std::string_view text) {
  SEXTANT_ASSIGN_OR_RETURN(AtomicFileWriter writer, AtomicFileWriter::Open(path));
  SEXTANT_RETURN_IF_ERROR(writer.Append(text));
  return writer.Commit();
}

}  // namespace sextant
