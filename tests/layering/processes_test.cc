// SPDX-License-Identifier: Apache-2.0
// Other programs are started in one place, and without a shell.
#include <gtest/gtest.h>

#include <regex>
#include <string>

#include "support/source_tree.h"

namespace sextant::test {
namespace {

// Functions that give a text to a shell.
const std::regex& ByShell() {
  static const std::regex calls(R"((^|[^\w.>])(std::|::)?(system|popen|wordexp)\s*\()");
  return calls;
}

// Functions that start a program.
const std::regex& Start() {
  static const std::regex calls(
      R"((^|[^\w.>])(::)?(fork|vfork|posix_spawnp?|exec(l|le|lp|v|ve|vp|vpe))\s*\()");
  return calls;
}

bool MayStartPrograms(const SourceFile& file) {
  return file.path == "base/process/run_process.cc" ||
         // In the background, with its own process group or measurement.
         file.path == "tests/support/display/virtual_display.cc" ||
         file.path == "bench/process_cost.cc" || file.path == "tests/support/cost/child_cost.cc";
}

std::string WithoutComment(const std::string& line) { return line.substr(0, line.find("//")); }

TEST(Processes, NoSourceUsesAShell) {
  for (const SourceFile& file : ReadSourceTree()) {
    if (!IsCpp(file) || file.path == "tests/layering/processes_test.cc") continue;
    // gnuplot's own function in a hostile text.
    if (file.path == "tests/support/hostile_text.h") continue;
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
      const std::string line = WithoutComment(file.lines[i]);
      EXPECT_FALSE(std::regex_search(line, ByShell()))
          << file.path << ":" << i + 1 << ": use RunProcess of base/process: " << line;
      // Tests may run a command line of their own, as a user would type it.
      const bool names_shell = line.find("/bin/sh") != std::string::npos;
      EXPECT_TRUE(!names_shell || file.folder.starts_with("tests/support"))
          << file.path << ":" << i + 1 << ": name the program itself: " << line;
    }
  }
}

TEST(Processes, OneSourceStartsPrograms) {
  for (const SourceFile& file : ReadSourceTree()) {
    if (!IsCpp(file) || MayStartPrograms(file) || file.path == "tests/layering/processes_test.cc") {
      continue;
    }
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
      const std::string line = WithoutComment(file.lines[i]);
      EXPECT_FALSE(std::regex_search(line, Start()))
          << file.path << ":" << i + 1 << ": use RunProcess of base/process: " << line;
    }
  }
}

TEST(Processes, TheChecksSeeWhatTheyLookFor) {
  for (const char* line : {"system(text)", "  std::system(x.c_str());", "FILE* f = popen(a, b);",
                           "if (::system (a))"}) {
    EXPECT_TRUE(std::regex_search(line, ByShell())) << line;
  }
  for (const char* line : {"filesystem(x)", "solar.system(x)", "coordinate_system(a)"}) {
    EXPECT_FALSE(std::regex_search(line, ByShell())) << line;
  }
  for (const char* line : {"fork()", "  execvp(a, b);", "posix_spawnp(&p, a)", "execl(a)"}) {
    EXPECT_TRUE(std::regex_search(line, Start())) << line;
  }
  EXPECT_FALSE(std::regex_search("Execute(a)", Start()));
}

// Scripts: no text is run as a command, and no variable is left to be split into words.
TEST(Processes, NoScriptEvaluatesText) {
  const std::regex evaluates(R"((^|[;&|({]\s*|\s)eval\s)");
  for (const SourceFile& file : ReadSourceTree()) {
    if (!file.path.starts_with("scripts/") || file.path.ends_with(".txt")) continue;
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
      const std::string& line = file.lines[i];
      if (line.starts_with('#')) continue;
      EXPECT_FALSE(std::regex_search(line, evaluates)) << file.path << ":" << i + 1 << ": " << line;
    }
  }
}

}  // namespace
}  // namespace sextant::test
