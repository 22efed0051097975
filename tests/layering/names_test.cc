// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <string>

#include "support/source_tree.h"

namespace sextant::test {
namespace {

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

}  // namespace
}  // namespace sextant::test
