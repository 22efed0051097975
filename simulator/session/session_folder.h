// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "io/output/output_folder.h"

namespace sextant {

/// The folder of a simulated session, which can continue an interrupted run.
class SessionFolder {
 public:
  /// Creates and locks the folder, or opens one with the same configuration. Errors: kIo;
  /// kInvalidInput if the folder has other contents; those of OutputFolder and OutputFile.
  static Expected<SessionFolder> Open(const std::filesystem::path& path,
                                      std::string_view scene_text, std::string_view configuration);

  /// Writes the file with the text from `make` unless it exists; returns whether it was written.
  Expected<bool> Complete(const std::string& name,
                          const std::function<Expected<std::string>()>& make) const;
  /// Writes the file, replacing one that sextant wrote.
  Expected<void> Write(const std::string& name, std::string_view text) const;

  /// Names of the files, without the lock. Error: kIo.
  Expected<std::vector<std::string>> FileNames() const;
  const std::filesystem::path& path() const { return folder_->path(); }
  /// The folder stays locked for as long as this object lives.
  std::shared_ptr<const OutputFolder> lock() const { return folder_; }

 private:
  explicit SessionFolder(std::shared_ptr<const OutputFolder> folder) : folder_(std::move(folder)) {}

  std::shared_ptr<const OutputFolder> folder_;
};

}  // namespace sextant
