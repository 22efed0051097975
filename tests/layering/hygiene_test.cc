// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cctype>
#include <optional>
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
