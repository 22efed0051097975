// SPDX-License-Identifier: Apache-2.0
// The header of every reader of files states how its time and memory are bounded.
#include <gtest/gtest.h>

#include <regex>
#include <string>

#include "support/source_tree.h"

namespace sextant::test {
namespace {

bool IsOfReaders(const SourceFile& file) {
  if (!file.path.ends_with(".h")) return false;
  for (const std::string folder : {"io", "calibrate", "eval", "simulator", "features", "report"}) {
    if (file.folder == folder || file.folder.starts_with(folder + "/")) return true;
  }
  return false;
}

// Whether a header declares a function that reads a file, or the text or bytes of one.
bool DeclaresReader(const std::string& text) {
  static const std::regex reader(R"(Expected<[^;{}]*> (Read|Parse|Open|Decode|Load)[A-Z]\w*\()"
                                 R"((const std::filesystem::path&|std::string_view (text|bytes)))");
  return std::regex_search(text, reader);
}

bool StatesBound(const std::string& text) {
  static const std::regex bound(
      R"(\b[Tt]ime and memory|\bTime( and|:| is| of)|[Mm]emory( is| are|:| and|,))");
  return std::regex_search(text, bound);
}

// The header on one line, with its comments as running text.
std::string TextOf(const SourceFile& file) {
  static const std::regex start_of_comment(R"(^\s*///?)");
  std::string text;
  for (const std::string& line : file.lines) {
    text += std::regex_replace(line, start_of_comment, "") + " ";
  }
  return std::regex_replace(text, std::regex(" +"), " ");
}

TEST(Bounds, EveryReaderStatesThem) {
  int readers = 0;
  for (const SourceFile& file : ReadSourceTree()) {
    if (!IsOfReaders(file)) continue;
    const std::string text = TextOf(file);
    // What is written, and single numbers.
    if (file.folder == "io/output" || file.path == "io/text/number_text.h") continue;
    if (!DeclaresReader(text)) continue;
    ++readers;
    EXPECT_TRUE(StatesBound(text))
        << file.path << ": state time and memory as a function of the size of the file";
  }
  EXPECT_GT(readers, 25);
}

TEST(Bounds, TheCheckSeesWhatItLooksFor) {
  EXPECT_TRUE(DeclaresReader("Expected<Rig> ReadRig(const std::filesystem::path& path);"));
  EXPECT_TRUE(DeclaresReader("Expected<std::vector<A>> ParseA(std::string_view text, int b);"));
  EXPECT_FALSE(DeclaresReader("Expected<void> WriteRig(const std::filesystem::path& path);"));
  EXPECT_FALSE(StatesBound("/// Errors: kIo; kParse."));
  EXPECT_TRUE(StatesBound("/// Errors: kIo. Time is linear in the size."));
}

}  // namespace
}  // namespace sextant::test
