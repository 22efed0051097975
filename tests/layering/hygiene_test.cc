// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cctype>
#include <optional>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

#include "support/source_tree.h"

namespace sextant::test {
namespace {

// Roots of paths that exist on one person's machine only.
const std::vector<std::string_view> kPrivateRoots = {"home", "root", "Users", "mnt"};

// Marks of unfinished work; each must name its reason or issue: MARK(reason).
const std::vector<std::string> kMarks = {std::string("TO") + "DO", std::string("FIX") + "ME",
                                         std::string("HA") + "CK"};

bool IsPartOfWord(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' || c == '}' ||
         c == ')' || c == '/';
}

// The first of kPrivateRoots that begins a path in the line; none where none does.
std::optional<std::string> PrivatePathIn(std::string_view line) {
  for (const std::string_view root : kPrivateRoots) {
    const std::string path = "/" + std::string(root) + "/";
    const std::size_t at = line.find(path);
    if (at == std::string_view::npos) continue;
    if (at == 0 || !IsPartOfWord(line[at - 1])) return path;
  }
  return std::nullopt;
}

bool HasMarkWithoutReason(std::string_view line) {
  for (const std::string& mark : kMarks) {
    const std::size_t at = line.find(mark);
    if (at != std::string_view::npos && !line.substr(at + mark.size()).starts_with('(')) {
      return true;
    }
  }
  return false;
}

bool NeedsLicenceLine(const SourceFile& file) {
  return IsCpp(file) || file.path.ends_with(".cmake") || file.path.ends_with("CMakeLists.txt") ||
         file.folder == "scripts";
}

TEST(Hygiene, EverySourceNamesItsLicence) {
  constexpr std::string_view kTag = "SPDX-License-Identifier: Apache-2.0";
  for (const SourceFile& file : ReadSourceTree()) {
    if (!NeedsLicenceLine(file)) continue;
    bool found = false;
    // The second line where the first is a script's "#!".
    for (std::size_t i = 0; i < file.lines.size() && i < 2; ++i) {
      found = found || file.lines[i].find(kTag) != std::string::npos;
    }
    EXPECT_TRUE(found) << file.path << ": begin it with the comment '" << kTag << "'";
  }
}

TEST(Hygiene, NoFileNamesAPathOfOneMachine) {
  for (const SourceFile& file : ReadSourceTree()) {
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
      const std::optional<std::string> path = PrivatePathIn(file.lines[i]);
      EXPECT_FALSE(path) << file.path << ":" << i + 1 << ": has " << *path;
    }
  }
}

bool IsOfTheLibraryOrProgram(const SourceFile& file) {
  for (const char* folder : {"tests", "bench", "examples"}) {
    if (file.folder.starts_with(folder)) return false;
  }
  return IsCpp(file);
}

// The arguments of the call whose opening parenthesis is at `open`.
std::string ArgumentsAt(const std::string& text, std::size_t open) {
  int depth = 0;
  for (std::size_t at = open; at < text.size(); ++at) {
    depth += text[at] == '(' ? 1 : text[at] == ')' ? -1 : 0;
    if (depth == 0) return text.substr(open + 1, at - open - 1);
  }
  return {};
}

// A loop of links, a name of 300 letters or a folder without permission makes them throw.
TEST(Hygiene, NoCallOfTheFileSystemThrows) {
  const std::regex call(
      R"((?:filesystem|fs)::(?:exists|is_\w+|file_size|remove|remove_all|rename|create_director\w+|)"
      R"(canonical|weakly_canonical|absolute|relative|equivalent|status|symlink_status|space|)"
      R"(last_write_time|copy\w*|resize_file|current_path|read_symlink|)"
      R"((?:recursive_)?directory_iterator(?: \w+)?)\()");
  const std::regex with_code(R"(,\s*\w*(?:error|ignored|failed|code)\w*\s*$)");
  for (const SourceFile& file : ReadSourceTree()) {
    if (!IsOfTheLibraryOrProgram(file)) continue;
    std::string text;
    for (const std::string& line : file.lines) text += line + "\n";
    for (std::sregex_iterator it(text.begin(), text.end(), call), end; it != end; ++it) {
      const auto open = static_cast<std::size_t>(it->position() + it->length()) - 1;
      const std::string arguments = ArgumentsAt(text, open);
      // The status of a file has been asked for already.
      EXPECT_TRUE(std::regex_search(arguments, with_code) || arguments == "status")
          << file.path << ": give the error code to " << it->str() << arguments << ")";
    }
    EXPECT_EQ(text.find(": std::filesystem::directory_iterator("), std::string::npos)
        << file.path << ": increment the iterator with an error code";
  }
}

TEST(Hygiene, NothingIsLeftUndoneWithoutAReason) {
  for (const SourceFile& file : ReadSourceTree()) {
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
      EXPECT_FALSE(HasMarkWithoutReason(file.lines[i]))
          << file.path << ":" << i + 1 << ": write MARK(reason), or do it: " << file.lines[i];
    }
  }
}

TEST(Hygiene, TheChecksSeeWhatTheyLookFor) {
  for (const std::string_view root : kPrivateRoots) {
    EXPECT_TRUE(PrivatePathIn("see '/" + std::string(root) + "/notes'")) << root;
    EXPECT_FALSE(PrivatePathIn("docs/" + std::string(root) + "/notes")) << root;
  }
  for (const std::string& mark : kMarks) {
    EXPECT_TRUE(HasMarkWithoutReason("// " + mark + ": later")) << mark;
    EXPECT_FALSE(HasMarkWithoutReason("// " + mark + "(issue 7): when g++ 13 is the oldest"))
        << mark;
  }
}

}  // namespace
}  // namespace sextant::test
