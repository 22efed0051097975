// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace sextant::test {

/// A text file of the project.
struct SourceFile {
  std::string path;    ///< Relative to the project's root: "solvers/kernels/kabsch.cc".
  std::string folder;  ///< "solvers"; empty for the root itself.
  std::vector<std::string> lines;
};

/// All text files of the project by path: sources, build files, scripts and pages, without build
/// folders and hidden ones.
std::vector<SourceFile> ReadSourceTree();

/// The project's root.
std::filesystem::path SourceRoot();

/// Whether the file is a C++ file.
bool IsCpp(const SourceFile& file);

/// Whether the project has this file.
bool Exists(const std::string& path_from_root);

}  // namespace sextant::test
