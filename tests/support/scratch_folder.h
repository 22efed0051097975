// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace sextant::test {

/// A new empty folder that is removed with its contents at the end of the test.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace sextant::test
