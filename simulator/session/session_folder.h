// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "base/error.h"

namespace sextant {

/// The folder of a simulated session, which can continue an interrupted run.
class SessionFolder {
 public:
  /// Creates the folder, or opens one with the same configuration and removes incomplete files of a
  /// killed run. Errors: kIo; kInvalidInput if the folder has other contents.
  static Expected<SessionFolder> Open(const std::filesystem::path& path,
                                      std::string_view scene_text, std::string_view configuration);

  /// Writes the file with the text from `make` unless it exists; returns whether it was written.
  Expected<bool> Complete(const std::string& name,
                          const std::function<Expected<std::string>()>& make) const;
  /// Writes the file, replacing an existing one.
  Expected<void> Write(const std::string& name, std::string_view text) const;

 private:
  explicit SessionFolder(std::filesystem::path path) : path_(std::move(path)) {}

  std::filesystem::path path_;
};

}  // namespace sextant
