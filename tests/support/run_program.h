// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace sextant::test {

struct ProgramRun {
  int exit_code = 0;
  std::string out;
  std::string err;
};

/// Runs the program in a shell without standard input; the caller quotes `arguments`.
ProgramRun RunProgram(const std::string& program, const std::string& arguments);

/// A folder for the running test only.
std::filesystem::path TestFolder();

/// Path of a file in that folder.
std::string TestPath(const std::string& name);

void WriteText(const std::filesystem::path& path, const std::string& text);
std::string ReadText(const std::filesystem::path& path);

}  // namespace sextant::test
