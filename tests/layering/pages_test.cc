// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "support/source_tree.h"

namespace sextant::test {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxReadmeColumns = 100;

// The anchor that a page's heading gets: lower case, spaces as hyphens, no punctuation.
std::string AnchorOf(std::string_view heading) {
  heading.remove_prefix(std::min(heading.find_first_not_of("# "), heading.size()));
  std::string anchor;
  for (const char c : heading) {
    const unsigned char byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 || c == '-' || c == '_') {
      anchor += static_cast<char>(std::tolower(byte));
    } else if (c == ' ') {
      anchor += '-';
    }
  }
  return anchor;
}

bool HasAnchor(const SourceFile& page, const std::string& anchor) {
  return std::ranges::any_of(page.lines, [&](const std::string& line) {
    return line.starts_with('#') && AnchorOf(line) == anchor;
  });
}

// The targets of the page's links to other files of the project: [text](target).
std::vector<std::string> LinksOf(const SourceFile& page) {
  static const std::regex link(R"(\]\(([^)\s]+)\))");
  std::vector<std::string> targets;
  bool in_code = false;
  for (const std::string& line : page.lines) {
    if (line.starts_with("```")) in_code = !in_code;
    if (in_code) continue;
    for (std::sregex_iterator found(line.begin(), line.end(), link), end; found != end; ++found) {
      const std::string target = (*found)[1];
      if (!target.starts_with("http")) targets.push_back(target);
    }
  }
  return targets;
}

TEST(Pages, EveryLinkLeadsToAFileOfTheProject) {
  const std::vector<SourceFile> files = ReadSourceTree();
  int links = 0;
  for (const SourceFile& page : files) {
    if (!page.path.ends_with(".md")) continue;
    for (const std::string& target : LinksOf(page)) {
      ++links;
      const std::size_t hash = std::min(target.find('#'), target.size());
      const std::string path =
          hash == 0 ? page.path
                    : (fs::path(page.folder) / target.substr(0, hash)).lexically_normal().string();
      EXPECT_TRUE(fs::exists(SourceRoot() / path)) << page.path << ": no file for " << target;
      if (hash == target.size()) continue;
      const auto linked = std::ranges::find(files, path, &SourceFile::path);
      EXPECT_TRUE(linked != files.end() && HasAnchor(*linked, target.substr(hash + 1)))
          << page.path << ": no heading for " << target;
    }
  }
  EXPECT_GT(links, 20);
}

// Whether a row of a table names a folder: in full, or its parent and then the names below it.
bool NamesFolder(const std::string& row, const std::string& folder) {
  const auto has = [&](const std::string& words) { return row.find(words) != std::string::npos; };
  if (has("`" + folder + "`")) return true;
  const std::size_t slash = folder.find('/');
  if (slash == std::string::npos) return false;
  const std::string root = folder.substr(0, slash);
  if (!has("`" + root + "`") && !has("`" + root + "/")) return false;
  return std::ranges::all_of(fs::path(folder.substr(slash + 1)), [&](const fs::path& part) {
    return has("`" + part.string() + "`") || has("/" + part.string() + "`");
  });
}

TEST(Pages, TheConventionsNameEveryFolderOfSources) {
  const std::vector<SourceFile> files = ReadSourceTree();
  const auto page = std::ranges::find(files, "docs/conventions.md", &SourceFile::path);
  ASSERT_TRUE(page != files.end());
  std::set<std::string> folders;
  for (const SourceFile& file : files) {
    if (IsCpp(file) && !file.folder.starts_with("tests")) folders.insert(file.folder);
  }
  EXPECT_GT(folders.size(), 50U);
  for (const std::string& folder : folders) {
    const auto names = [&](const std::string& line) {
      return line.starts_with("| `") && NamesFolder(line, folder);
    };
    EXPECT_TRUE(std::ranges::any_of(page->lines, names)) << folder;
  }
}

// Whether a file of the tests defines TEST(suite, name), TEST_F or TEST_P; "*" is any name.
bool IsTest(const std::vector<SourceFile>& files, const std::string& suite,
            const std::string& name) {
  const std::string begin = "(" + suite + ", " + (name == "*" ? "" : name + ")");
  return std::ranges::any_of(files, [&](const SourceFile& file) {
    return file.path.ends_with("_test.cc") &&
           std::ranges::any_of(file.lines, [&](const std::string& line) {
             return line.starts_with("TEST") && line.find(begin) != std::string::npos;
           });
  });
}

TEST(Pages, TheTestsThatHoldPromisesExist) {
  static const std::regex named(R"(`([A-Z]\w+)\.([A-Z]\w+|\*)`)");
  const std::vector<SourceFile> files = ReadSourceTree();
  const auto page = std::ranges::find(files, "docs/reliability.md", &SourceFile::path);
  ASSERT_TRUE(page != files.end());
  int tests = 0;
  for (const std::string& line : page->lines) {
    for (std::sregex_iterator found(line.begin(), line.end(), named), end; found != end; ++found) {
      ++tests;
      EXPECT_TRUE(IsTest(files, (*found)[1], (*found)[2])) << page->path << ": " << found->str();
    }
  }
  EXPECT_GT(tests, 10);
}

TEST(Pages, TheReadmeFitsAWindow) {
  for (const SourceFile& page : ReadSourceTree()) {
    if (page.path != "README.md") continue;
    for (std::size_t i = 0; i < page.lines.size(); ++i) {
      EXPECT_LE(page.lines[i].size(), kMaxReadmeColumns) << "README.md:" << i + 1;
    }
  }
}

}  // namespace
}  // namespace sextant::test
