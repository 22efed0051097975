// SPDX-License-Identifier: Apache-2.0
// The example files in docs/formats.md are accepted by their readers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <set>

#include "calibrate/session/session.h"
#include "io/boards/board_file.h"
#include "io/boards/polygon_file.h"
#include "io/problems/pairs_csv.h"
#include "io/problems/problem_yaml.h"
#include "io/problems/rig_yaml.h"
#include "io/results/calibration_result.h"
#include "io/text/text_file.h"
#include "simulator/scene/scene_file.h"
#include "support/run_program.h"
#include "support/source_tree.h"

namespace sextant {
namespace {

/// A fenced block of a page.
struct Block {
  std::string text{};
  std::string first_word{};  ///< First line, up to a colon or a comma.
  int line = 0;              ///< Line of the page on which the text begins.
};

std::vector<Block> FencedBlocks(const std::string& page) {
  std::vector<Block> blocks;
  bool is_inside = false;
  int number = 0;
  for (std::size_t at = 0; at < page.size();) {
    const std::size_t end = std::min(page.find('\n', at), page.size() - 1);
    const std::string line = page.substr(at, end + 1 - at);
    at = end + 1;
    ++number;
    if (line.starts_with("```")) {
      is_inside = !is_inside;
      if (is_inside) blocks.push_back({.line = number + 1});
    } else if (is_inside) {
      Block& block = blocks.back();
      if (block.text.empty()) block.first_word = line.substr(0, line.find_first_of(":,\n"));
      block.text += line;
    }
  }
  return blocks;
}

/// The error of a reader; empty if it accepts the text.
template <class T>
std::string Refusal(Expected<T> (*parse)(std::string_view, const std::string&),
                    const std::string& text, const std::string& name) {
  const Expected<T> read = parse(text, name);
  return read ? "" : read.error().message;
}

// The files to which the example of a session refers.
void WriteSessionFiles() {
  for (const char* name :
       {"photos/pose1.png", "scans/pose1.pcd", "boards.yaml", "camera_info.yaml"}) {
    const std::filesystem::path path = test::TestPath(name);
    std::filesystem::create_directories(path.parent_path());
    test::WriteText(path, "");
  }
}

TEST(FormatsPage, ItsExamplesAreAccepted) {
  const Expected<std::string> page = ReadTextFile(test::SourceRoot() / "docs/formats.md");
  ASSERT_TRUE(page) << page.error().message;
  WriteSessionFiles();
  const std::string name = test::TestPath("example.yaml");
  const std::map<std::string, std::function<std::string(const std::string&)>> readers = {
      {"sextant_problem", [&](const auto& text) { return Refusal(ParseProblemYaml, text, name); }},
      {"sextant_rig", [&](const auto& text) { return Refusal(ParseRigFile, text, name); }},
      {"boards", [&](const auto& text) { return Refusal(ParseBoards, text, name); }},
      {"sextant_session", [&](const auto& text) { return Refusal(ParseSession, text, name); }},
      {"sextant_scene", [&](const auto& text) { return Refusal(ParseScene, text, name); }},
      {"u", [&](const auto& text) { return Refusal(ParsePairsCsv, text, name); }},
      {"sextant_polygons", [&](const auto& text) { return Refusal(ParsePolygons, text, name); }},
      {"sextant_result",
       [&](const auto& text) { return Refusal(ParseCalibrationResult, text, name); }}};
  std::set<std::string> seen;
  for (const Block& block : FencedBlocks(*page)) {
    const auto reader = readers.find(block.first_word);
    ASSERT_NE(reader, readers.end())
        << "docs/formats.md:" << block.line << ": no reader for " << block.first_word;
    EXPECT_EQ(reader->second(block.text), "") << "docs/formats.md:" << block.line;
    seen.insert(block.first_word);
  }
  EXPECT_EQ(seen.size(), readers.size());
}

TEST(FormatsPage, TheResultHasTheEulerAnglesOfItsPose) {
  const Expected<std::string> page = ReadTextFile(test::SourceRoot() / "docs/formats.md");
  ASSERT_TRUE(page) << page.error().message;
  for (const Block& block : FencedBlocks(*page)) {
    if (block.first_word != "sextant_result") continue;
    const Expected<CalibrationResult> result = ParseCalibrationResult(block.text, "result");
    ASSERT_TRUE(result) << result.error().message;
    const std::string written = FormatCalibrationResult(*result);
    for (const char* key : {"  quaternion_wxyz:", "  euler_zyx_deg:"}) {
      const std::size_t at = block.text.find(key);
      ASSERT_NE(at, std::string::npos) << key;
      EXPECT_THAT(written,
                  testing::HasSubstr(block.text.substr(at, block.text.find('\n', at) - at)));
    }
  }
}

}  // namespace
}  // namespace sextant
