// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "support/source_tree.h"

namespace sextant::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::size_t kMaxFilesInFolder = 40;

// Programs: they may use every library, and no library may use them.
constexpr std::array<std::string_view, 5> kPrograms = {"bench", "cli", "examples", "python",
                                                       "tests"};

// What sextant_library(<folder> PUBLIC ... PRIVATE ...) names, and where a library is optional
// target_link_libraries(sextant_<folder> ...) too.
struct LinkLine {
  std::vector<std::string> public_links;
  std::vector<std::string> private_links;
  std::vector<std::string> interface_links;  // For those who link the folder: it includes none.
};
using LinkLines = std::map<std::string, LinkLine>;  // By folder.

struct Include {
  std::string place;  // "solvers/core/solver.cc:7".
  std::string header;
  bool is_ours = false;  // Quoted.
  bool is_in_header = false;
};

bool Contains(const std::vector<std::string>& texts, const std::string& text) {
  return std::ranges::count(texts, text) > 0;
}

std::vector<std::string> AllLinks(const LinkLine& line) {
  std::vector<std::string> links = line.public_links;
  links.insert(links.end(), line.private_links.begin(), line.private_links.end());
  return links;
}

std::string TargetOf(std::string folder) {
  std::ranges::replace(folder, '/', '_');
  return "sextant::" + folder;
}

bool IsProgram(std::string_view folder) {
  return std::ranges::count(kPrograms, folder.substr(0, folder.find('/'))) > 0;
}

// Adds the links that the arguments of a CMake call name after PUBLIC, PRIVATE and INTERFACE.
void AddLinks(const std::string& arguments, LinkLine& line) {
  std::istringstream words(arguments);
  std::vector<std::string>* links = nullptr;
  for (std::string word; words >> word;) {
    if (word == "PUBLIC") {
      links = &line.public_links;
    } else if (word == "PRIVATE") {
      links = &line.private_links;
    } else if (word == "INTERFACE") {
      links = &line.interface_links;
    } else if (links != nullptr) {
      links->push_back(word);
    }
  }
}

LinkLines ReadLinkLines(const std::vector<SourceFile>& files) {
  static const std::regex call(R"((sextant_library|target_link_libraries)\(\s*(\S+)([^)]*)\))");
  LinkLines result;
  for (const SourceFile& file : files) {
    if (!file.path.ends_with("CMakeLists.txt")) continue;
    std::string text;
    for (const std::string& line : file.lines) text += line.substr(0, line.find('#')) + '\n';
    std::string target = "sextant_" + file.folder;
    std::ranges::replace(target, '/', '_');
    for (std::sregex_iterator found(text.begin(), text.end(), call), end; found != end; ++found) {
      const std::string name = (*found)[2];
      const bool is_folder = (*found)[1] == "sextant_library" && name == file.folder;
      if (is_folder || name == target) AddLinks((*found)[3], result[file.folder]);
    }
  }
  return result;
}

std::vector<Include> IncludesOf(const SourceFile& file) {
  static const std::regex include(R"(#\s*include\s+(["<])([^">]+)[">].*)");
  std::vector<Include> result;
  for (std::size_t i = 0; i < file.lines.size(); ++i) {
    std::smatch match;
    if (!file.lines[i].starts_with('#') || !std::regex_match(file.lines[i], match, include)) {
      continue;
    }
    result.push_back({.place = file.path + ":" + std::to_string(i + 1),
                      .header = match[2],
                      .is_ours = match[1] == "\"",
                      .is_in_header = file.path.ends_with(".h")});
  }
  return result;
}

// Whether <header> may come from the library: a word of the library's name and the header's path
// begin with the same two letters, as opencv_core and <opencv2/core.hpp>, PkgConfig::LZF and
// <lzf.h>, BZip2::BZip2 and <bzlib.h> do.
bool MayComeFrom(const std::string& library, const std::string& header) {
  const auto is_letter = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) ==
           std::tolower(static_cast<unsigned char>(b));
  };
  for (std::size_t i = 0; i + 1 < library.size(); ++i) {
    const bool begins_word = i == 0 || !is_letter(library[i - 1]);
    if (begins_word && std::equal(header.begin(), header.begin() + 2, &library[i], same)) {
      return true;
    }
  }
  return false;
}

bool IsOurs(const std::string& link) { return link.starts_with("sextant::"); }

// The link lines' libraries of others that may hold the header.
std::vector<std::string> LibrariesFor(const std::string& header,
                                      const std::vector<std::string>& links) {
  std::vector<std::string> result;
  for (const std::string& link : links) {
    if (!IsOurs(link) && MayComeFrom(link, header)) result.push_back(link);
  }
  return result;
}

// The names that would satisfy the include: one folder's target, or the libraries of others.
// Empty for headers of the language, of the system, and of the folder itself.
std::vector<std::string> NeededFor(const Include& include, const std::string& folder,
                                   const std::vector<std::string>& all_links) {
  if (!include.is_ours) {
    // The standard library's headers have neither a dot nor a slash; Eigen's have a slash.
    if (include.header.find_first_of("./") == std::string::npos) return {};
    return LibrariesFor(include.header, all_links);
  }
  const std::string to = include.header.substr(0, include.header.rfind('/'));
  if (to == folder) return {};
  return {TargetOf(to)};
}

bool AnyIn(const std::vector<std::string>& names, const std::vector<std::string>& links) {
  return std::ranges::any_of(names, [&](const std::string& name) { return Contains(links, name); });
}

void AppendIncludeFaults(const std::string& folder, const LinkLine& line,
                         const std::vector<Include>& includes,
                         const std::vector<std::string>& all_links,
                         std::vector<std::string>& faults) {
  const std::vector<std::string> own_links = AllLinks(line);
  std::set<std::string> used;
  std::set<std::string> used_by_headers;
  for (const Include& include : includes) {
    const std::vector<std::string> needed = NeededFor(include, folder, all_links);
    if (needed.empty()) continue;
    const std::string where = include.place + ": includes " + include.header + ", but ";
    const std::string link_line = "the link line of " + folder;
    if (!AnyIn(needed, own_links)) {
      faults.push_back(where + link_line + " does not name " + needed.front());
    } else if (include.is_in_header && !AnyIn(needed, line.public_links)) {
      faults.push_back(where + link_line + " does not name " + needed.front() + " as PUBLIC");
    }
    used.insert(needed.begin(), needed.end());
    if (include.is_in_header) used_by_headers.insert(needed.begin(), needed.end());
  }
  for (const std::string& link : own_links) {
    if (!used.contains(link)) {
      faults.push_back("the link line of " + folder + " names " + link +
                       ", but no source there includes it");
    }
  }
  for (const std::string& link : line.public_links) {
    if (used.contains(link) && !used_by_headers.contains(link)) {
      faults.push_back("the link line of " + folder + " names " + link +
                       " as PUBLIC, but no header there includes it");
    }
  }
}

// Every fault of the link lines against the includes of the files; a line of text each.
std::vector<std::string> LinkFaults(const LinkLines& lines, const std::vector<SourceFile>& files) {
  std::map<std::string, std::vector<Include>> includes;
  for (const SourceFile& file : files) {
    if (!IsCpp(file) || IsProgram(file.folder)) continue;
    std::vector<Include>& of_folder = includes[file.folder];
    for (const Include& include : IncludesOf(file)) of_folder.push_back(include);
  }
  std::set<std::string> distinct_links;
  for (const auto& [folder, line] : lines) {
    for (const std::string& link : AllLinks(line)) distinct_links.insert(link);
  }
  const std::vector<std::string> all_links(distinct_links.begin(), distinct_links.end());
  std::vector<std::string> faults;
  for (const auto& [folder, of_folder] : includes) {
    if (!lines.contains(folder)) {
      faults.push_back(folder + " has sources, but its CMakeLists.txt has no sextant_library()");
      continue;
    }
    AppendIncludeFaults(folder, lines.at(folder), of_folder, all_links, faults);
  }
  return faults;
}

// The folders of a circle of link lines, from `folder` on; empty where there is none.
std::vector<std::string> CircleFrom(const std::string& folder, const LinkLines& lines,
                                    std::vector<std::string> path, std::set<std::string>& done) {
  if (Contains(path, folder)) {
    path.erase(path.begin(), std::ranges::find(path, folder));
    path.push_back(folder);
    return path;
  }
  if (!done.insert(folder).second) return {};
  path.push_back(folder);
  std::vector<std::string> links = AllLinks(lines.at(folder));
  const std::vector<std::string>& passed_on = lines.at(folder).interface_links;
  links.insert(links.end(), passed_on.begin(), passed_on.end());
  for (const auto& [next, line] : lines) {
    if (!Contains(links, TargetOf(next))) continue;
    std::vector<std::string> circle = CircleFrom(next, lines, path, done);
    if (!circle.empty()) return circle;
  }
  return {};
}

std::vector<std::string> FindCircle(const LinkLines& lines) {
  std::set<std::string> done;
  for (const auto& [folder, line] : lines) {
    std::vector<std::string> circle = CircleFrom(folder, lines, {}, done);
    if (!circle.empty()) return circle;
  }
  return {};
}

TEST(Layering, LinkLinesNameExactlyWhatIsIncluded) {
  const std::vector<SourceFile> files = ReadSourceTree();
  const LinkLines lines = ReadLinkLines(files);
  EXPECT_GT(lines.size(), 20U);
  for (const std::string& fault : LinkFaults(lines, files)) ADD_FAILURE() << fault;
}

TEST(Layering, LinkLinesFormNoCircle) {
  EXPECT_THAT(FindCircle(ReadLinkLines(ReadSourceTree())), IsEmpty());
}

TEST(Layering, EveryIncludedHeaderStandsWhereItsNameSays) {
  for (const SourceFile& file : ReadSourceTree()) {
    if (!IsCpp(file) || file.folder == "tests/install/consumer") continue;
    for (const Include& include : IncludesOf(file)) {
      if (!include.is_ours) continue;
      EXPECT_TRUE(Exists(include.header) || Exists("tests/" + include.header))
          << include.place << ": " << include.header << " names no file of the project";
    }
  }
}

TEST(Layering, NoFolderIsCrowded) {
  std::map<std::string, std::size_t> counts;
  for (const SourceFile& file : ReadSourceTree()) {
    if (IsCpp(file)) ++counts[file.folder];
  }
  for (const auto& [folder, count] : counts) {
    EXPECT_LE(count, kMaxFilesInFolder) << folder << " has " << count << " sources: split it";
  }
}

// The faults of a folder `top` that links `links` and has one file with one include, above a
// folder `low` and beside one that links every library named below.
std::vector<std::string> FaultsOf(const std::string& links, const std::string& file,
                                  const std::string& include) {
  const std::vector<SourceFile> files = {
      {.path = "low/CMakeLists.txt", .folder = "low", .lines = {"sextant_library(low)"}},
      {.path = "other/CMakeLists.txt",
       .folder = "other",
       .lines = {"sextant_library(other PRIVATE fmt::fmt", "  opencv_core)"}},
      {.path = "top/CMakeLists.txt",
       .folder = "top",
       .lines = {"sextant_library(top " + links + ")"}},
      {.path = "top/" + file, .folder = "top", .lines = {"#include " + include}},
  };
  return LinkFaults(ReadLinkLines(files), files);
}

TEST(Layering, FaultsAreSeen) {
  EXPECT_THAT(FaultsOf("PRIVATE sextant::low", "a.cc", "\"low/b.h\""), IsEmpty());
  EXPECT_THAT(FaultsOf("PUBLIC sextant::low", "a.h", "\"low/b.h\""), IsEmpty());
  EXPECT_THAT(FaultsOf("", "a.cc", "\"top/b.h\""), IsEmpty());
  EXPECT_THAT(FaultsOf("", "a.cc", "\"low/b.h\""),
              ElementsAre(HasSubstr("does not name sextant::low")));
  EXPECT_THAT(FaultsOf("PRIVATE sextant::low", "a.h", "\"low/b.h\""),
              ElementsAre(HasSubstr("does not name sextant::low as PUBLIC")));
  EXPECT_THAT(FaultsOf("PUBLIC sextant::low", "a.cc", "\"low/b.h\""),
              ElementsAre(HasSubstr("no header there includes it")));
  EXPECT_THAT(FaultsOf("PRIVATE sextant::low", "a.cc", "<vector>"),
              ElementsAre(HasSubstr("no source there includes it")));
  EXPECT_THAT(FaultsOf("", "a.cc", "\"cli/help.h\""),
              ElementsAre(HasSubstr("does not name sextant::cli")));
  EXPECT_THAT(FaultsOf("", "a.cc", "<unistd.h>"), IsEmpty());
  EXPECT_THAT(FaultsOf("PRIVATE opencv_core", "a.cc", "<opencv2/core.hpp>"), IsEmpty());
  EXPECT_THAT(FaultsOf("", "a.cc", "<fmt/core.h>"),
              ElementsAre(HasSubstr("does not name fmt::fmt")));
  EXPECT_THAT(FaultsOf("PRIVATE fmt::fmt", "a.h", "<fmt/core.h>"),
              ElementsAre(HasSubstr("does not name fmt::fmt as PUBLIC")));
  EXPECT_THAT(FaultsOf("PRIVATE fmt::fmt", "a.cc", "<string>"),
              ElementsAre(HasSubstr("no source there includes it")));
}

TEST(Layering, CirclesAreSeen) {
  const LinkLine to_b = {
      .public_links = {"sextant::b"}, .private_links = {}, .interface_links = {}};
  const LinkLine to_c = {
      .public_links = {}, .private_links = {"sextant::x_c"}, .interface_links = {}};
  EXPECT_THAT(FindCircle({{"a", to_b}, {"b", to_c}, {"x/c", {}}}), IsEmpty());
  EXPECT_THAT(FindCircle({{"a", to_b}, {"b", to_c}, {"x/c", to_b}}), ElementsAre("b", "x/c", "b"));
}

}  // namespace
}  // namespace sextant::test
