// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <regex>
#include <string>
#include <string_view>

#include "support/source_tree.h"

namespace sextant::test {
namespace {

// A wording, and the field's term for it: docs/conventions.md, Terms.
struct Wording {
  std::string_view found;
  std::string_view instead;
};

constexpr std::array<Wording, 18> kWordings = {{
    {"///< Of ", "a noun, or a sentence with a subject"},
    {"// Of ", "a noun, or a sentence with a subject"},
    {"drawn anew", "bootstrap over views"},
    {"views left out", "jackknife (leave-one-view-out)"},
    {"says of itself", "data diagnostics"},
    {"side by side", "vectorised, a SIMD vector of 8 doubles"},
    {"quiet machine", "an idle machine"},
    {"Untold", "unobservable"},
    {"told too", "underestimated, overestimated"},
    {"told intrinsics", "assumed intrinsics"},
    {"kMost", "kMax"},
    {"kFewest", "kMin"},
    {"WeighedPairs", "WeightedPairs"},
    {"weighed alike", "equal weights"},
    {"pair of chance", "random pair"},
    {"HoldAgainstItself", "CrossValidate"},
    {"the least that", "the minimum"},
    {"PairJudge", "PairScorer"},
}};

// Two types of one name in one namespace compile alone and corrupt memory once linked together.
TEST(Names, EveryTypeOfTheLibraryIsDefinedInOneHeader) {
  const std::regex definition(R"(^(?:struct|class|enum class) (\w+)(?: final)?(?: : [^;]*)? \{.*)");
  std::map<std::string, std::string> defined_in;
  for (const SourceFile& file : ReadSourceTree()) {
    if (!IsCpp(file) || !file.path.ends_with(".h")) continue;
    // The program's and the tests' headers have namespaces of their own.
    if (file.folder == "cli" || file.folder == "tests" || file.folder == "bench") continue;
    for (const std::string& line : file.lines) {
      std::smatch match;
      if (!std::regex_match(line, match, definition)) continue;
      const auto [place, is_new] = defined_in.emplace(match[1], file.path);
      EXPECT_TRUE(is_new) << match[1] << " is defined in " << place->second << " and in "
                          << file.path;
    }
  }
  EXPECT_GT(defined_in.size(), 30U);
}

// The terms of the glossary in sources, pages, scripts and messages.
TEST(Names, WordsAreThoseOfTheField) {
  for (const SourceFile& file : ReadSourceTree()) {
    const bool is_list = file.path == "tests/layering/names_test.cc";
    // Boards may well stand side by side.
    const bool is_experiment = file.path.starts_with("paper") || file.folder == "experiments";
    if (is_list || is_experiment) continue;
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
      for (const Wording& wording : kWordings) {
        if (file.lines[i].find(wording.found) == std::string::npos) continue;
        ADD_FAILURE() << file.path << ":" << i + 1 << ": instead of \"" << wording.found
                      << "\" write \"" << wording.instead << "\": " << file.lines[i];
      }
    }
  }
}

}  // namespace
}  // namespace sextant::test
