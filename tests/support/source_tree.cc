// SPDX-License-Identifier: Apache-2.0
#include "support/source_tree.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace sextant::test {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 10> kTextSuffixes = {
    ".cc", ".h", ".txt", ".cmake", ".in", ".md", ".yaml", ".json", ".py", ".sh"};

// Scripts are text files without a suffix.
bool IsText(const fs::path& path) {
  const std::string suffix = path.extension().string();
  return suffix.empty() || std::ranges::count(kTextSuffixes, suffix) > 0;
}

bool IsHiddenOrBuilt(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.starts_with('.') || name == "build";
}

SourceFile Read(const fs::path& path) {
  SourceFile file;
  const fs::path relative = path.lexically_relative(SEXTANT_SOURCE_DIR);
  file.path = relative.generic_string();
  file.folder = relative.parent_path().generic_string();
  std::ifstream stream(path);
  for (std::string line; std::getline(stream, line);) file.lines.push_back(line);
  return file;
}

}  // namespace

std::vector<SourceFile> ReadSourceTree() {
  std::vector<SourceFile> files;
  fs::recursive_directory_iterator entry(SEXTANT_SOURCE_DIR);
  for (; entry != fs::recursive_directory_iterator(); ++entry) {
    if (entry->is_directory() && IsHiddenOrBuilt(entry->path())) {
      entry.disable_recursion_pending();
    } else if (entry->is_regular_file() && IsText(entry->path()) &&
               !IsHiddenOrBuilt(entry->path())) {
      files.push_back(Read(entry->path()));
    }
  }
  std::ranges::sort(files, {}, &SourceFile::path);
  return files;
}

std::filesystem::path SourceRoot() { return SEXTANT_SOURCE_DIR; }

bool IsCpp(const SourceFile& file) {
  return file.path.ends_with(".cc") || file.path.ends_with(".h");
}

bool Exists(const std::string& path_from_root) {
  return fs::is_regular_file(fs::path(SEXTANT_SOURCE_DIR) / path_from_root);
}

}  // namespace sextant::test
