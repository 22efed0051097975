// SPDX-License-Identifier: Apache-2.0
#include "io/output/output_folder.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "base/descriptor.h"
#include "base/text/path_text.h"
#include "io/output/lock_holders.h"
#include "io/output/temporary.h"
#include "io/output/write_all.h"
#include "io/output/write_error.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLockFile = ".sextant.lock";

// Whether the file is new, or one of ours: a regular one without another name, of numbers alone.
bool IsLockFile(const Descriptor& file) {
  struct stat status {};
  if (fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode) || status.st_nlink > 1) {
    return false;
  }
  std::array<char, 64> bytes{};
  const ssize_t got = pread(file.get(), bytes.data(), bytes.size(), 0);
  return std::all_of(bytes.begin(), bytes.begin() + std::max<ssize_t>(got, 0),
                     [](char c) { return c == '\n' || (c >= '0' && c <= '9'); });
}

// Temporaries whose writer has ended: nobody holds their locks.
void RemoveLeftovers(const fs::path& path, int folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(path, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (IsTemporaryName(name)) names.push_back(name);
  }
  for (const std::string& name : names) {
    const Descriptor file(
        openat(folder, name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    if (!file.is_open() || flock(file.get(), LOCK_EX | LOCK_NB) != 0) continue;
    unlinkat(folder, name.c_str(), 0);
  }
}

}  // namespace

Expected<void> MakeFolder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (!error && fs::is_directory(path, error)) return {};
  if (!error) error = std::make_error_code(std::errc::not_a_directory);
  return MakeError(ErrorCode::kUnwritable,
                   fmt::format("cannot make the folder '{}': {}; name another folder",
                               PathText(path), error.message()));
}

Expected<void> MakeSubfolder(const fs::path& path) {
  std::error_code error;
  if (fs::is_symlink(path, error)) {
    const std::string end = fs::read_symlink(path, error).string();
    return WriteError(
        ErrorCode::kInvalidOption, path,
        fmt::format("it is a link to '{}'; remove it, or choose another folder", PathText(end)));
  }
  SEXTANT_RETURN_IF_ERROR(MakeFolder(path));
  const Descriptor folder(open(path.c_str(), O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  if (!folder.is_open()) return {};
  // It may be a folder of results itself, which another process uses.
  const Descriptor lock(
      openat(folder.get(), kLockFile, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  const bool is_used = lock.is_open() && flock(lock.get(), LOCK_EX | LOCK_NB) != 0;
  if (!is_used) RemoveLeftovers(path, folder.get());
  return {};
}

class OutputFolder::Lock {
 public:
  explicit Lock(Descriptor folder) : folder_(std::move(folder)) {}
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;
  ~Lock() {
    if (on_signal_) on_signal_->Keep();
    // A lock that others share stays with them.
    if (!is_held_ || flock(file_.get(), LOCK_EX | LOCK_NB) != 0) return;
    unlinkat(folder_.get(), kLockFile, 0);
  }

  // True once it is held; false if other processes hold it. A process that was killed a moment ago
  // holds it until it has ended. Errors: kUnwritable.
  Expected<bool> Take(const fs::path& path, Sharing sharing) {
    constexpr auto kPatience = std::chrono::seconds(2);
    const auto begin = std::chrono::steady_clock::now();
    while (true) {
      SEXTANT_ASSIGN_OR_RETURN(const bool is_held, TryToTake(path, sharing));
      if (is_held || std::chrono::steady_clock::now() - begin > kPatience) return is_held;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }

  // After Take(): lets others in that share the folder.
  bool Share() { return flock(file_.get(), LOCK_SH | LOCK_NB) == 0; }
  void RemoveOnSignal() { on_signal_.emplace(folder_.get(), kLockFile); }

  int folder() const { return folder_.get(); }
  int file() const { return file_.get(); }
  bool is_alone() const { return is_alone_; }

 private:
  Expected<bool> TryToTake(const fs::path& path, Sharing sharing) {
    while (true) {
      constexpr int kFlags = O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
      file_ = Descriptor(openat(folder_.get(), kLockFile, kFlags, 0666));
      if (!file_.is_open()) return WriteError(path / kLockFile);
      if (!IsLockFile(file_)) {
        return WriteError(ErrorCode::kInvalidOption, path / kLockFile,
                          "it is no lock of sextant, which needs this name; remove the file");
      }
      // A file system without locks cannot keep others out.
      is_alone_ = flock(file_.get(), LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
      const bool is_shared = !is_alone_ && sharing == Sharing::kWithOthers &&
                             flock(file_.get(), LOCK_SH | LOCK_NB) == 0;
      if (!is_alone_ && !is_shared) return false;
      // Its last holder may have removed the file meanwhile.
      if (IsNamed()) break;
    }
    is_held_ = true;
    if (is_alone_ && ftruncate(file_.get(), 0) != 0) return WriteError(path / kLockFile);
    if (!WriteAll(file_.get(), fmt::format("{}\n", getpid()))) return WriteError(path / kLockFile);
    return true;
  }

  bool IsNamed() const {
    struct stat open_file {};
    struct stat named {};
    return fstat(file_.get(), &open_file) == 0 &&
           fstatat(folder_.get(), kLockFile, &named, AT_SYMLINK_NOFOLLOW) == 0 &&
           open_file.st_ino == named.st_ino && open_file.st_dev == named.st_dev;
  }

  Descriptor folder_;
  Descriptor file_;
  bool is_held_ = false;
  bool is_alone_ = false;
  std::optional<Temporary> on_signal_;
};

OutputFolder::OutputFolder(fs::path path, std::unique_ptr<Lock> lock)
    : path_(std::move(path)), lock_(std::move(lock)) {}
OutputFolder::OutputFolder(OutputFolder&&) noexcept = default;
OutputFolder::~OutputFolder() = default;

Expected<OutputFolder> OutputFolder::Open(const fs::path& path, Sharing sharing) {
  SEXTANT_RETURN_IF_ERROR(MakeFolder(path));
  Descriptor folder(open(path.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  if (!folder.is_open()) return WriteError(path);
  auto lock = std::make_unique<Lock>(std::move(folder));
  SEXTANT_ASSIGN_OR_RETURN(bool is_held, lock->Take(path, sharing));
  if (is_held && lock->is_alone()) RemoveLeftovers(path, lock->folder());
  if (is_held && sharing == Sharing::kWithOthers) is_held = lock->Share();
  if (!is_held) {
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("the folder '{}' is in use by {}; wait until it ends, or choose "
                                 "another folder",
                                 PathText(path), DescribeHolders(lock->file())));
  }
  if (sharing == Sharing::kAlone) lock->RemoveOnSignal();
  return OutputFolder(path, std::move(lock));
}

bool OutputFolder::IsPassing(const std::string& name) {
  return name == kLockFile || IsTemporaryName(name);
}

}  // namespace sextant
