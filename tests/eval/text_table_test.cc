// SPDX-License-Identifier: Apache-2.0
#include "eval/statistics/text_table.h"

#include <gtest/gtest.h>

namespace sextant {
namespace {

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

TEST(Fixed, DropsTheSignOfZeroOnly) {
  EXPECT_EQ(Fixed(-1e-9, 3), "0.000");
  EXPECT_EQ(Fixed(-0.5, 0), "0");
  EXPECT_EQ(Fixed(-0.0016, 3), "-0.002");
  EXPECT_EQ(Fixed(2.0, 1), "2.0");
}

}  // namespace
}  // namespace sextant
