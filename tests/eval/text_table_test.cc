// SPDX-License-Identifier: Apache-2.0
#include "eval/statistics/text_table.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

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
