// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cctype>
#include <string>
#include <string_view>
#include <vector>

#include "support/source_tree.h"

namespace sextant::test {
namespace {

// What changes files, or writes to the standard streams. Only io/output may: it looks after inputs,
// links, full disks and files of others. Words between blanks, with their namespace where needed.
constexpr std::string_view kNames =
    " ofstream basic_ofstream basic_fstream std::fstream O_WRONLY O_RDWR O_CREAT O_TRUNC O_APPEND"
    " std::cout std::cerr std::clog stdout stderr ";
constexpr std::string_view kCalls =
    " fopen freopen creat mkstemp mkstemps mkdtemp tmpfile tmpnam ftruncate truncate unlink"
    " unlinkat rename renameat link symlink mkdir rmdir remove remove_all copy_file resize_file"
    " create_directory create_directories create_symlink create_hard_link imwrite"
    " cairo_pdf_surface_create cairo_svg_surface_create cairo_ps_surface_create"
    " cairo_surface_write_to_png fmt::print printf fprintf puts fputs fputc putchar ";

bool Has(std::string_view words, const std::string& word) {
  return words.find(" " + word + " ") != std::string_view::npos;
}

bool Writes(std::string_view code) {
  const auto is_of_name = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
  };
  for (std::size_t begin = 0; begin < code.size();) {
    std::size_t end = begin;
    while (end < code.size() && is_of_name(code[end])) ++end;
    const std::string name(code.substr(begin, end - begin));
    const bool has_space = begin >= 5 && code.substr(begin - 2, 2) == "::";
    const std::string full = has_space ? std::string(code.substr(begin - 5, 5)) + name : name;
    const bool is_called = end < code.size() && code[end] == '(';
    if (Has(kNames, name) || Has(kNames, full)) return true;
    if (is_called && (Has(kCalls, name) || Has(kCalls, full))) return true;
    begin = end + 1;
  }
  return false;
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
      if (!Writes(CodeOf(file.lines[i]))) continue;
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
    EXPECT_TRUE(Writes(line)) << line;
  }
  for (const char* line :
       {"#include <fstream>", "std::ifstream in(path);", "open(path, O_RDONLY | O_CLOEXEC)",
        "std::remove_if(a, b, c);", "RemoveFile(path);", "fingerprint(x);",
        "name.remove_prefix(1);", "std::fputs_of(x);"}) {
    EXPECT_FALSE(Writes(line)) << line;
  }
}

}  // namespace
}  // namespace sextant::test
