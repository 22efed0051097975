// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "support/scratch_folder.h"

namespace sextant::test {

/// A file that each input overwrites, for readers that need a path.
class InputFile {
 public:
  explicit InputFile(const std::string& name) : path_(folder_.path() / name) {}

  /// Returns the path of the file with these bytes.
  const std::filesystem::path& Write(std::string_view bytes) {
    std::ofstream(path_, std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path_;
  }

 private:
  ScratchFolder folder_;
  std::filesystem::path path_;
};

}  // namespace sextant::test
