// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "base/error.h"

namespace sextant {

/// The folder of a simulated session, which goes on where an earlier run was stopped.
class SessionFolder {
 public:
  /// Makes the folder or takes up the one of the same configuration, and removes what a killed run
  /// left half written. Errors: kIo; kInvalidInput where something else is in the folder.
  static Expected<SessionFolder> Open(const std::filesystem::path& path,
                                      std::string_view scene_text, std::string_view configuration);

  /// Writes the file that `make` gives, unless it is there already; whether it was written.
  Expected<bool> Complete(const std::string& name,
                          const std::function<Expected<std::string>()>& make) const;
  Expected<void> Write(const std::string& name, std::string_view text) const;

 private:
  explicit SessionFolder(std::filesystem::path path) : path_(std::move(path)) {}

  std::filesystem::path path_;
};

}  // namespace sextant
