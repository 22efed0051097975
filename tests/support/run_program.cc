// SPDX-License-Identifier: Apache-2.0
#include "support/run_program.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <memory>

#include "base/process/run_process.h"
#include "support/scratch_folder.h"

namespace sextant::test {

std::filesystem::path TestFolder() {
  static std::unique_ptr<ScratchFolder> folder;
  static const testing::TestInfo* owner = nullptr;
  const testing::TestInfo* current = testing::UnitTest::GetInstance()->current_test_info();
  if (owner != current) {
    folder = std::make_unique<ScratchFolder>();
    owner = current;
  }
  return folder->path();
}

std::string TestPath(const std::string& name) { return (TestFolder() / name).string(); }

void WriteText(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::string ReadText(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

ProgramRun RunProgram(const std::string& program, const std::string& arguments) {
  const std::filesystem::path folder = TestFolder();
  const std::string command = program + " " + arguments + " >" + (folder / "stdout").string() +
                              " 2>" + (folder / "stderr").string() + " </dev/null";
  const Expected<ProcessEnd> end =
      RunProcess({"/bin/sh", "-c", command}, {.timeout = std::chrono::hours(1)});
  return {end ? end->exit_code : -1, ReadText(folder / "stdout"), ReadText(folder / "stderr")};
}

}  // namespace sextant::test
