// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <regex>
#include <string>
#include <string_view>
#include <vector>

#include "support/source_tree.h"

namespace sextant::test {
namespace {

// What changes files, or writes to the standard streams. Only io/output may: it looks after inputs,
// links, full disks and files of others.
const std::regex& WritingCall() {
  static const std::regex call(
      R"(\b(o|basic_o|basic_)fstream\b|\bstd::fstream\b|\bO_(WRONLY|RDWR|CREAT|TRUNC|APPEND)\b)"
      R"(|\b(fopen|freopen|creat|mkstemps?|mkdtemp|tmpfile|tmpnam|ftruncate|truncate|unlink|unlinkat)\()"
      R"(|\b(rename|renameat|link|symlink|mkdir|rmdir|remove|remove_all|copy_file|resize_file)\()"
      R"(|\bcreate_(directory|directories|symlink|hard_link)\(|\bimwrite\()"
      R"(|\bcairo_(pdf|svg|ps)_surface_create\(|\bcairo_surface_write_to_png\()"
      R"(|\bfmt::print\(|\bf?printf\(|\bf?puts\(|\bfputc\(|\bputchar\()"
      R"(|\bstd::(cout|cerr|clog)\b|\bstd(out|err)\b)");
  return call;
}

bool IsOfTheProgram(const SourceFile& file) {
  for (const std::string_view other : {"bench", "tests", "examples", "build"}) {
    if (file.folder == other || file.folder.starts_with(std::string(other) + "/")) return false;
  }
  return IsCpp(file);
}

std::string CodeOf(const std::string& line) { return line.substr(0, line.find("//")); }

TEST(Outputs, OnlyTheOutputLayerWrites) {
  int found = 0;
  for (const SourceFile& file : ReadSourceTree()) {
    if (!IsOfTheProgram(file)) continue;
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
      if (!std::regex_search(CodeOf(file.lines[i]), WritingCall())) continue;
      ++found;
      EXPECT_EQ(file.folder, "io/output")
          << file.path << ":" << i + 1 << ": use io/output: " << file.lines[i];
    }
  }
  EXPECT_GT(found, 5);
}

TEST(Outputs, TheCheckSeesWhatItLooksFor) {
  for (const char* line :
       {"std::ofstream out(path);", "open(path, O_RDWR | O_CREAT)", "std::fopen(name, \"w\")",
        "fs::remove(path, error);", "std::filesystem::rename(a, b);", "cv::imwrite(name, image);",
        "fmt::print(\"{}\", text);", "std::cerr << text;", "fs::create_directories(path);"}) {
    EXPECT_TRUE(std::regex_search(std::string(line), WritingCall())) << line;
  }
  for (const char* line :
       {"#include <fstream>", "std::ifstream in(path);", "open(path, O_RDONLY | O_CLOEXEC)",
        "std::remove_if(a, b, c);", "RemoveFile(path);", "fingerprint(x);",
        "name.remove_prefix(1);", "std::fputs_of(x);"}) {
    EXPECT_FALSE(std::regex_search(std::string(line), WritingCall())) << line;
  }
}

}  // namespace
}  // namespace sextant::test
