// SPDX-License-Identifier: Apache-2.0
#include "io/output/output_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdio>

#include "io/output/file_mark.h"
#include "io/output/write_all.h"
#include "io/output/write_error.h"

namespace sextant {
namespace {

// A new file of this name; an existing one, or a link, is not opened.
Descriptor CreateFile(int folder, const std::string& name, mode_t mode) {
  constexpr int kFlags = O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
  Descriptor file(openat(folder, name.c_str(), kFlags, mode));
  // The lock shows a process that cleans up that this one still runs (OutputFolder).
  if (file.is_open()) flock(file.get(), LOCK_EX | LOCK_NB);
  return file;
}

// Waits for no reader of a pipe: that may never come.
Expected<Descriptor> OpenStream(const std::filesystem::path& path) {
  constexpr int kFlags = O_WRONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY;
  Descriptor file(open(path.c_str(), kFlags));
  if (!file.is_open() && errno == ENXIO) {
    return WriteError(ErrorCode::kInvalidOption, path,
                      "it is a pipe that no process reads; start the reader first, or remove it");
  }
  if (!file.is_open()) return WriteError(path);
  // Writing then waits for the reader as usual.
  const int flags = fcntl(file.get(), F_GETFL);
  if (flags < 0 || fcntl(file.get(), F_SETFL, flags & ~O_NONBLOCK) != 0) return WriteError(path);
  return file;
}

bool IsStillThere(const Descriptor& file) {
  struct stat status {};
  return fstat(file.get(), &status) == 0 && status.st_nlink > 0;
}

}  // namespace

Expected<OutputFile> OutputFile::Open(const std::filesystem::path& path, Replace replace,
                                      OutputUse use) {
  SEXTANT_ASSIGN_OR_RETURN(OutputTarget target, FindTarget(path));
  OutputFile output(std::move(target));
  if (output.target_.is_stream) {
    SEXTANT_ASSIGN_OR_RETURN(output.file_, OpenStream(path));
    return output;
  }
  if (CallFiles* const call = CallFiles::Current(); call != nullptr) {
    const std::string why = call->BeginOutput(output.target_.id, use);
    if (!why.empty()) return WriteError(ErrorCode::kInvalidOption, path, why);
  }
  SEXTANT_RETURN_IF_ERROR(CheckReplaceable(output.target_, replace));
  SEXTANT_RETURN_IF_ERROR(output.OpenTemporary());
  return output;
}

Expected<void> OutputFile::OpenTemporary() {
  const mode_t mode = target_.existing ? target_.existing->st_mode & 0777U : 0666U;
  const int folder = target_.folder.get();
  constexpr int kAttempts = 100;
  for (int i = 0; i < kAttempts; ++i) {
    const std::string name = TemporaryName(target_.name);
    file_ = CreateFile(folder, name, mode);
    if (!file_.is_open() && errno != EEXIST) return WriteError(target_.path);
    if (!file_.is_open() || !IsStillThere(file_)) continue;
    temporary_.emplace(folder, name);
    return {};
  }
  return WriteError(target_.path);
}

Expected<void> OutputFile::Append(std::string_view bytes) {
  if (!WriteAll(file_.get(), bytes)) return WriteError(target_.path);
  return {};
}

Expected<void> OutputFile::WriteAt(std::uint64_t offset, std::string_view bytes) {
  const int fd = file_.get();
  const bool ok = lseek(fd, static_cast<off_t>(offset), SEEK_SET) >= 0 && WriteAll(fd, bytes) &&
                  lseek(fd, 0, SEEK_END) >= 0;
  if (!ok) return WriteError(target_.path);
  return {};
}

Expected<void> OutputFile::Commit() {
  if (!temporary_) {
    if (!file_.Close()) return WriteError(target_.path);
    return {};
  }
  const int folder = target_.folder.get();
  const int fd = file_.get();
  const std::string temporary = temporary_->name();
  struct stat written {};
  if (target_.existing && fchmod(fd, target_.existing->st_mode & 0777U) != 0) {
    return WriteError(target_.path);
  }
  if (fsync(fd) != 0) return WriteError(target_.path);
  MarkAsWritten(fd);
  const bool ok = fstat(fd, &written) == 0 && file_.Close() &&
                  renameat(folder, temporary.c_str(), folder, target_.name.c_str()) == 0;
  if (!ok) return WriteError(target_.path);
  temporary_->Keep();
  if (CallFiles* const call = CallFiles::Current(); call != nullptr) {
    call->FinishOutput(target_.id, IdOf(written));
  }
  // The new name is on the disk once the folder is. Some file systems cannot flush a folder.
  const Descriptor readable(openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (readable.is_open() && fsync(readable.get()) != 0 && errno == EIO) {
    return WriteError(target_.path);
  }
  return {};
}

std::filesystem::path OutputFile::temporary() const {
  if (!temporary_) return {};
  return target_.path.parent_path() / temporary_->name();
}

Expected<void> WriteFileAtomically(const std::filesystem::path& path, std::string_view bytes,
                                   Replace replace, OutputUse use) {
  SEXTANT_ASSIGN_OR_RETURN(OutputFile file, OutputFile::Open(path, replace, use));
  SEXTANT_RETURN_IF_ERROR(file.Append(bytes));
  return file.Commit();
}

}  // namespace sextant
