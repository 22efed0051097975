// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/stat.h>

#include <compare>
#include <map>
#include <mutex>
#include <set>
#include <string>

namespace sextant {

/// A file by device and inode, whatever its name. For a file that does not exist: those of its
/// folder, and its name in it.
struct FileId {
  dev_t device = 0;
  ino_t inode = 0;
  std::string name{};  ///< Empty for a file that exists.

  auto operator<=>(const FileId&) const = default;  // NOLINT(modernize-use-nullptr)
};

inline FileId IdOf(const struct stat& status) { return {status.st_dev, status.st_ino, {}}; }

/// How a file is written by one call of the program.
struct OutputUse {
  bool may_be_read = false;  ///< It may be read before it is written, to continue it.
  bool is_repeated = false;  ///< It may be written more than once.
  /// The caller knows the existing file for one of sextant's, even if the system does not.
  bool is_recognised = false;
};

/// The files that one call of the program reads and writes. While an object exists, readers and
/// writers (io/output) report their files to it, and it refuses an output that is also an input or
/// another output. A program that uses the library and makes no object is not restricted.
///
/// The functions return why the file must not be used, or an empty text. Thread-safe.
class CallFiles {
 public:
  /// `may_overwrite`: writers may replace files that sextant did not write.
  explicit CallFiles(bool may_overwrite);
  ~CallFiles();
  CallFiles(const CallFiles&) = delete;
  CallFiles& operator=(const CallFiles&) = delete;

  /// The object of this process; null if there is none.
  static CallFiles* Current();

  bool may_overwrite() const { return may_overwrite_; }

  /// Before the file is read.
  std::string AddInput(const FileId& file);
  /// Before any work: the file will be written later.
  std::string ClaimOutput(const FileId& file, OutputUse use);
  /// Before the file is written, claimed or not.
  std::string BeginOutput(const FileId& file, OutputUse use);
  /// Whether it was claimed so.
  bool IsRecognised(const FileId& file);
  /// The content of `before` was replaced by the file `now`.
  void FinishOutput(const FileId& before, const FileId& now);

 private:
  struct Output {
    OutputUse use{};
    bool is_begun = false;
    bool is_finished = false;
  };

  bool may_overwrite_;
  std::mutex mutex_;
  std::set<FileId> inputs_;
  std::map<FileId, Output> outputs_;
};

/// AddInput of the process's object, if there is one.
std::string NoteInput(const struct stat& status);

}  // namespace sextant
