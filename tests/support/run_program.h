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

/// Runs the program as a user's shell would, without standard input; `arguments` are quoted by the
/// caller.
ProgramRun RunProgram(const std::string& program, const std::string& arguments);

/// A folder of the running test's own; the next test gets another.
std::filesystem::path TestFolder();

/// Of a file there.
std::string TestPath(const std::string& name);

void WriteText(const std::filesystem::path& path, const std::string& text);
std::string ReadText(const std::filesystem::path& path);

}  // namespace sextant::test
