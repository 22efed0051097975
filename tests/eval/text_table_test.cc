// SPDX-License-Identifier: Apache-2.0
#include "eval/statistics/text_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/text/code_point.h"
#include "support/hostile_text.h"
#include "support/source_tree.h"

namespace sextant {
namespace {

// Separators of columns; an escaped ampersand is text.
std::ptrdiff_t CountSeparators(const std::string& line) {
  std::ptrdiff_t count = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    count += line[i] == '&' && (i == 0 || line[i - 1] != '\\') ? 1 : 0;
  }
  return count;
}

// Checks that every row of every tabular has as many cells as the tabular has columns, and returns
// the number of rows.
int ExpectFullRows(const std::string& latex, const std::string& name) {
  const std::string begin = "\\begin{tabular}{";
  std::istringstream lines(latex);
  std::ptrdiff_t columns = 0;
  int rows = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(begin)) columns = std::ssize(line) - std::ssize(begin) - 1;
    if (!line.ends_with("\\\\")) continue;
    EXPECT_EQ(CountSeparators(line) + 1, columns) << name << ": " << line;
    ++rows;
  }
  return rows;
}

TEST(TextTable, AlignsNumbersRightAndWordsLeft) {
  TextTable numbers({"name", "mm"});
  numbers.AddRow({"a", "1.25"});
  numbers.AddRow({"long name", "10.00"});
  EXPECT_EQ(numbers.Plain(),
            "name          mm\n"
            "----------------\n"
            "a           1.25\n"
            "long name  10.00\n");
  EXPECT_EQ(numbers.Markdown(), "| name | mm |\n|:--|--:|\n| a | 1.25 |\n| long name | 10.00 |\n");
  TextTable words({"a", "b"}, TextTable::Columns::kWords);
  words.AddRow({"x", "yes"});
  EXPECT_EQ(words.Plain(), "a  b\n------\nx  yes\n");
}

TEST(TextTable, WrapsTheWidestColumns) {
  TextTable table({"name", "choices", "meaning"}, TextTable::Columns::kWords);
  table.AddRow({"family", "tag16h5|tag25h9|tag36h10|tag36h11", "which tags are searched for"});
  EXPECT_EQ(table.Plain(50),
            "name    choices               meaning\n"
            "--------------------------------------------------\n"
            "family  tag16h5|tag25h9|      which tags are\n"
            "        tag36h10|tag36h11     searched for\n");
  table.AddRow({"x", std::string(1000, 'y'), std::string(1000, 'z')});
  std::istringstream lines(table.Plain(50));
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 50U) << line;
}

// Texts of others are cells of every output.
TEST(TextTable, TheLastColumnsOfWideTablesFollowBelow) {
  TextTable table({"solver", "x [m]", "y [m]", "time [us]"});
  table.AddRow({"ransac(kabsch,seed=3)", "1.25", "-3.5", "17.0"});
  EXPECT_EQ(table.Plain(32),
            "solver        x [m]  y [m]\n"
            "--------------------------\n"
            "ransac(        1.25   -3.5\n"
            "kabsch,\n"
            "seed=3)\n"
            "\n"
            "solver        time [us]\n"
            "-----------------------\n"
            "ransac(            17.0\n"
            "kabsch,\n"
            "seed=3)\n");
  for (int i = 0; i < 20; ++i) table.AddRow({std::string(50, 'a'), "1", "2", "3"});
  std::istringstream lines(table.Plain());
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100U) << line;
}

TEST(TextTable, HostileCellsStayInTheirRow) {
  TextTable table({"a", "b"}, TextTable::Columns::kWords);
  for (const std::string& text : test::HostileTexts()) {
    if (text.size() < 100) table.AddRow({text, text});
  }
  const auto rows = [](const std::string& text) {
    return std::count(text.begin(), text.end(), '\n');
  };
  const auto count = static_cast<std::ptrdiff_t>(
      std::count_if(test::HostileTexts().begin(), test::HostileTexts().end(),
                    [](const std::string& text) { return text.size() < 100; }));
  EXPECT_EQ(rows(table.Plain(std::string::npos)), count + 2);
  EXPECT_EQ(rows(table.Markdown()), count + 2);
  EXPECT_EQ(ExpectFullRows(table.Latex(), "table"), count + 1);
  for (std::string text : {table.Plain(), table.Markdown(), table.Latex()}) {
    std::erase(text, '\n');
    EXPECT_TRUE(IsPlainLine(text));
  }
}

TEST(LengthText, IsInMillimetresBelowAMetre) {
  EXPECT_EQ(LengthText(0.00821334), "8.21334 mm");
  EXPECT_EQ(LengthText(0.0), "0.00000 mm");
  EXPECT_EQ(LengthText(1.25), "1.25000000 m");
}

TEST(TextTable, LatexRowsHaveAllCellsEvenIfTheyAreEmpty) {
  TextTable table({"", "x & y [mm]", ""});
  table.AddRow({"", "", "5 %"});
  table.AddRow({"a_b", "1", ""});
  EXPECT_EQ(table.Latex(),
            "\\begin{tabular}{lrr}\n\\toprule\n"
            " & x \\& y [mm] &  \\\\\n\\midrule\n"
            " &  & 5 \\% \\\\\n"
            "a\\_b & 1 &  \\\\\n\\bottomrule\n\\end{tabular}\n");
  EXPECT_EQ(ExpectFullRows(table.Latex(), "table"), 3);
}

TEST(TextTable, LatexTablesOfThePaperHaveFullRows) {
  int rows = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::SourceRoot() / "paper")) {
    const std::filesystem::path path = entry.path() / "tables.tex";
    if (!std::filesystem::exists(path)) continue;
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    rows += ExpectFullRows(text.str(), path.string());
  }
  EXPECT_GT(rows, 100);
}

TEST(Fixed, DropsTheSignOfZeroOnly) {
  EXPECT_EQ(Fixed(-1e-9, 3), "0.000");
  EXPECT_EQ(Fixed(-0.5, 0), "0");
  EXPECT_EQ(Fixed(-0.0016, 3), "-0.002");
  EXPECT_EQ(Fixed(2.0, 1), "2.0");
}

}  // namespace
}  // namespace sextant
