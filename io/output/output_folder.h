// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "base/error.h"

namespace sextant {

/// Creates the folder with its parents if it does not exist. Error: kUnwritable.
Expected<void> MakeFolder(const std::filesystem::path& path);

/// Creates a folder within a locked folder of results if it does not exist, and removes temporary
/// files that a killed process left in it, unless others use it. A link in its place is refused,
/// because it may lead out of that folder. Time: linear in the folder's files. Errors:
/// kInvalidOption; kUnwritable.
Expected<void> MakeSubfolder(const std::filesystem::path& path);

/// Who may write into a folder at the same time.
enum class Sharing {
  kAlone,       ///< Nobody else.
  kWithOthers,  ///< Others that share it too: the parts of an experiment.
};

/// A folder that a command writes results into, locked for as long as the object lives: a file
/// .sextant.lock in it holds the numbers of the processes. The system frees the lock of a process
/// that ends, however it ends.
class OutputFolder {
 public:
  /// Creates the folder with its parents if it does not exist, and locks it. If nobody else uses
  /// it, removes temporary files that a killed process left. Waits up to two seconds for a process
  /// that uses it. Errors: kInvalidOption with the numbers of these processes; kUnwritable.
  static Expected<OutputFolder> Open(const std::filesystem::path& path,
                                     Sharing sharing = Sharing::kAlone);
  OutputFolder(OutputFolder&&) noexcept;
  OutputFolder& operator=(OutputFolder&&) = delete;
  ~OutputFolder();

  const std::filesystem::path& path() const { return path_; }
  /// Whether a file of this name is the folder's lock, or a temporary of a process at work.
  static bool IsPassing(const std::string& name);

 private:
  class Lock;
  OutputFolder(std::filesystem::path path, std::unique_ptr<Lock> lock);

  std::filesystem::path path_;
  std::unique_ptr<Lock> lock_;
};

}  // namespace sextant
