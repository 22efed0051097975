// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "eval/experiment/run/row_checksum.h"
#include "eval/experiment/run/row_file.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

tl::unexpected<Error> Unwritable(const std::filesystem::path& path) {
  const bool full = errno == ENOSPC || errno == EDQUOT || errno == EFBIG;
  return MakeError(
      ErrorCode::kIo,
      fmt::format(
          "cannot write '{}': {}{}", Printable(path.string(), 300),
          std::generic_category().message(errno),
          full
              ? "; the rows written so far are kept: free some space and run the same command again"
              : ""));
}

bool WriteAll(int fd, std::string_view bytes, std::uint64_t offset) {
  while (!bytes.empty()) {
    const ssize_t written = pwrite(fd, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
    offset += static_cast<std::uint64_t>(written);
  }
  return true;
}

// Whether the file contains only the beginning of a header, from a run that was killed before its
// first block.
bool IsTornHeader(int fd, std::uint64_t size, const std::string& header) {
  if (size >= header.size()) return false;
  std::string begun(size, '\0');
  return pread(fd, begun.data(), size, 0) == static_cast<ssize_t>(size) &&
         header.starts_with(begun);
}

}  // namespace

RowFileWriter::~RowFileWriter() {
  if (fd_ >= 0) close(fd_);
}

RowFileWriter::RowFileWriter(RowFileWriter&& other) noexcept
    : path_(std::move(other.path_)),
      fd_(std::exchange(other.fd_, -1)),
      bytes_(other.bytes_),
      kept_(std::move(other.kept_)),
      damage_(std::move(other.damage_)),
      is_orderly_(other.is_orderly_) {}

Expected<RowFileWriter> RowFileWriter::Open(const std::filesystem::path& path,
                                            const std::string& configuration, bool fresh) {
  RowFileWriter writer;
  writer.path_ = path;
  writer.fd_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK, 0666);
  struct stat status {};
  if (writer.fd_ < 0 || fstat(writer.fd_, &status) != 0) return Unwritable(path);
  if (!S_ISREG(status.st_mode)) {
    return MakeError(ErrorCode::kIo, fmt::format("cannot write '{}': it is not a regular file",
                                                 Printable(path.string(), 300)));
  }
  SEXTANT_RETURN_IF_ERROR(writer.Lock());
  const std::string header = RowFileHeader(configuration);
  const auto size = static_cast<std::uint64_t>(status.st_size);
  if (!fresh && !IsTornHeader(writer.fd_, size, header)) {
    SEXTANT_RETURN_IF_ERROR(writer.Keep(configuration));
    return writer;
  }
  if (ftruncate(writer.fd_, 0) != 0 || !WriteAll(writer.fd_, header, 0)) return Unwritable(path);
  writer.bytes_ = header.size();
  return writer;
}

Expected<void> RowFileWriter::Lock() {
  if (flock(fd_, LOCK_EX | LOCK_NB) == 0) return {};
  return MakeError(
      ErrorCode::kIo,
      fmt::format(
          "'{}' is being written by another run; wait for it, or choose another folder with --out",
          Printable(path_.string(), 300)));
}

Expected<void> RowFileWriter::Keep(const std::string& configuration) {
  SEXTANT_ASSIGN_OR_RETURN(const RowFileReader reader, RowFileReader::Open(path_));
  if (reader.configuration() != configuration) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("'{}' holds the rows of another configuration of the experiment; "
                                 "start over with --fresh, or choose another folder with --out",
                                 Printable(path_.string(), 300)));
  }
  bytes_ = reader.whole_bytes();
  damage_ = DescribeDamage(reader);
  is_orderly_ = reader.is_orderly();
  for (const RowBlockPlace& block : reader.blocks()) kept_.push_back(block.number);
  if (ftruncate(fd_, static_cast<off_t>(bytes_)) != 0) return Unwritable(path_);
  return {};
}

Expected<void> RowFileWriter::Append(std::string_view block) {
  if (WriteAll(fd_, block, bytes_)) {
    bytes_ += block.size();
    return {};
  }
  const int reason = errno;
  // If this fails too, the next run cuts off the incomplete block.
  const int ignored = ftruncate(fd_, static_cast<off_t>(bytes_));
  static_cast<void>(ignored);
  errno = reason;
  return Unwritable(path_);
}

Expected<void> RowFileWriter::Flush() {
  if (fsync(fd_) != 0) return Unwritable(path_);
  return {};
}

}  // namespace sextant
