// SPDX-License-Identifier: Apache-2.0
#include "io/output/appended_file.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "io/output/file_mark.h"
#include "io/output/lock_holders.h"
#include "io/output/write_all.h"
#include "io/output/write_error.h"

namespace sextant {

tl::unexpected<Error> AppendedFile::Failed() const {
  const bool full = errno == ENOSPC || errno == EDQUOT || errno == EFBIG;
  return WriteError(
      ErrorCode::kUnwritable, target_.path,
      fmt::format("{}{}", std::generic_category().message(errno),
                  full ? "; what was written so far is kept: free some space and run the same "
                         "command again"
                       : ""));
}

Expected<OutputTarget> AppendedFile::Target(const std::filesystem::path& path) {
  SEXTANT_ASSIGN_OR_RETURN(OutputTarget target, FindTarget(path));
  if (!target.is_stream) return target;
  return WriteError(ErrorCode::kInvalidOption, path, "it is not a regular file");
}

Expected<void> AppendedFile::Claim(const std::filesystem::path& path) {
  SEXTANT_ASSIGN_OR_RETURN(const OutputTarget target, Target(path));
  CallFiles* const call = CallFiles::Current();
  const std::string why = call != nullptr ? call->ClaimOutput(target.id, {}) : "";
  if (!why.empty()) return WriteError(ErrorCode::kInvalidOption, path, why);
  return {};
}

Expected<AppendedFile> AppendedFile::Open(const std::filesystem::path& path) {
  SEXTANT_ASSIGN_OR_RETURN(OutputTarget target, Target(path));
  CallFiles* const call = CallFiles::Current();
  if (call != nullptr) {
    const std::string why = call->BeginOutput(target.id, {.may_be_read = true});
    if (!why.empty()) return WriteError(ErrorCode::kInvalidOption, path, why);
  }
  AppendedFile appended(std::move(target));
  constexpr int kFlags = O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
  const OutputTarget& opened = appended.target_;
  appended.file_ = Descriptor(openat(opened.folder.get(), opened.name.c_str(), kFlags, 0666));
  if (!appended.file_.is_open()) return appended.Failed();
  SEXTANT_RETURN_IF_ERROR(appended.Lock());
  struct stat status {};
  if (fstat(appended.file_.get(), &status) != 0) return appended.Failed();
  if (status.st_nlink > 1) {
    return WriteError(ErrorCode::kInvalidOption, path,
                      fmt::format("it has {} names (hard links) and would change under each; "
                                  "replace this one by a copy",
                                  status.st_nlink));
  }
  appended.size_ = static_cast<std::uint64_t>(status.st_size);
  if (call != nullptr) call->FinishOutput(opened.id, IdOf(status));
  return appended;
}

Expected<void> AppendedFile::Lock() {
  if (flock(file_.get(), LOCK_EX | LOCK_NB) == 0) return {};
  return WriteError(ErrorCode::kInvalidOption, target_.path,
                    fmt::format("{} writes it; wait until it ends, or name another one",
                                DescribeLockers(file_.get())));
}

Expected<std::string> AppendedFile::ReadBeginning(std::uint64_t count) const {
  return Read(0, std::min(count, size_));
}

Expected<std::string> AppendedFile::ReadEnd(std::uint64_t count) const {
  const std::uint64_t some = std::min(count, size_);
  return Read(size_ - some, some);
}

Expected<std::string> AppendedFile::Read(std::uint64_t begin, std::uint64_t count) const {
  std::string bytes(count, '\0');
  const ssize_t got = pread(file_.get(), bytes.data(), bytes.size(), static_cast<off_t>(begin));
  if (got < 0) return Failed();
  bytes.resize(static_cast<std::size_t>(got));
  return bytes;
}

Expected<void> AppendedFile::Truncate(std::uint64_t size) {
  if (ftruncate(file_.get(), static_cast<off_t>(size)) != 0) return Failed();
  size_ = size;
  return {};
}

Expected<void> AppendedFile::Append(std::string_view bytes) {
  const int fd = file_.get();
  if (lseek(fd, static_cast<off_t>(size_), SEEK_SET) >= 0 && WriteAll(fd, bytes)) {
    size_ += bytes.size();
    return {};
  }
  const int reason = errno;
  // If this fails too, the next run cuts off the incomplete end.
  const int ignored = ftruncate(fd, static_cast<off_t>(size_));
  static_cast<void>(ignored);
  errno = reason;
  return Failed();
}

Expected<void> AppendedFile::Flush() {
  if (fsync(file_.get()) != 0) return Failed();
  MarkAsWritten(file_.get());
  return {};
}

}  // namespace sextant
