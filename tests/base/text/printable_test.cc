// SPDX-License-Identifier: Apache-2.0
#include "base/text/printable.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "base/error.h"
#include "base/text/code_point.h"
#include "base/text/file_name.h"
#include "support/hostile_text.h"

namespace sextant {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(CodePoint, ReadsUtf8) {
  const auto value = [](std::string_view text) { return FirstCodePoint(text).value; };
  EXPECT_EQ(value("a"), U'a');
  EXPECT_EQ(value("\xc3\xbc"), U'\u00fc');
  EXPECT_EQ(value("\xe6\x97\xa5"), U'\u65e5');
  EXPECT_EQ(value("\xf0\x9f\x98\x80"), U'\U0001f600');
  EXPECT_EQ(value("\xf4\x8f\xbf\xbf"), U'\U0010ffff');
}

TEST(CodePoint, RefusesWhatIsNotUtf8) {
  for (const char* text :
       {"\x80", "\xff", "\xc3", "\xc3(", "\xc0\xaf", "\xe0\x80\xaf", "\xed\xa0\x80", "\xe2\x82",
        "\xf0\x80\x80\x80", "\xf4\x90\x80\x80", "\xf8\x88\x80\x80\x80"}) {
    EXPECT_FALSE(FirstCodePoint(text).is_valid) << text;
    EXPECT_EQ(FirstCodePoint(text).bytes, 1U) << text;
  }
}

TEST(CodePoint, KnowsControlCharacters) {
  const std::vector<char32_t> controls = {0x00,   0x09,   0x0a,   0x1b,   0x1f,   0x7f,
                                          0x80,   0x85,   0x9b,   0x9f,   0x2028, 0x2029,
                                          0x202a, 0x202e, 0x2066, 0x2069, 0xfffe, 0xffff};
  for (const char32_t value : controls) {
    EXPECT_TRUE(IsControl(value)) << static_cast<unsigned>(value);
  }
  const std::vector<char32_t> others = {0x20,   0x7e,   0xa0,   0xfc,  0x2027,
                                        0x202f, 0x2065, 0x206a, 0xfffd};
  for (const char32_t value : others) {
    EXPECT_FALSE(IsControl(value)) << static_cast<unsigned>(value);
  }
}

TEST(Printable, OneLineHasNothingThatATerminalObeys) {
  for (const std::string& text : test::HostileTexts()) {
    EXPECT_TRUE(IsPlainLine(PrintableLine(text))) << PrintableLine(text);
    EXPECT_EQ(PrintableLine(PrintableLine(text)), PrintableLine(text));
    if (IsPlainLine(text)) {
      EXPECT_EQ(PrintableLine(text), text);
    }
  }
}

TEST(Printable, ShowsTheBytes) {
  EXPECT_EQ(PrintableLine("a\nb\x1b[0m\x7f"), "a\\x0ab\\x1b[0m\\x7f");
  EXPECT_EQ(PrintableLine("\x80\xff"), "\\x80\\xff");
  EXPECT_EQ(PrintableLine("\xc2\x9b \xe2\x80\xae"), "\\u009b \\u202e");
  EXPECT_EQ(PrintableLine("gr\xc3\xbc\xc3\x9f"), "gr\xc3\xbc\xc3\x9f");
}

TEST(Printable, LinesKeepsLineFeedsOnly) {
  EXPECT_EQ(PrintableLines("a\nb\r\tc\x1b\n"), "a\nb\\x0d\\x09c\\x1b\n");
  for (const std::string& text : test::HostileTexts()) {
    std::string line = PrintableLines(text);
    std::erase(line, '\n');
    EXPECT_TRUE(IsPlainLine(line)) << line;
  }
}

TEST(Printable, IsCutBetweenCodePoints) {
  EXPECT_EQ(Printable("abc", 3), "abc");
  EXPECT_EQ(Printable("abcd", 3), "abc...");
  EXPECT_EQ(Printable("ab\xc3\xbc", 3), "ab...");
  for (const std::string& text : test::HostileTexts()) {
    EXPECT_TRUE(IsPlainLine(Printable(text, 20)));
    EXPECT_LE(Printable(text, 20).size(), 23U);
    EXPECT_LE(Quoted(text).size(), 45U);
    EXPECT_TRUE(IsPlainLine(Quoted(text)));
  }
}

TEST(Error, IsOneSafeLine) {
  for (const std::string& text : test::HostileTexts()) {
    EXPECT_TRUE(IsPlainLine(Error(ErrorCode::kIo, "cannot read " + text).message));
  }
  Error error(ErrorCode::kIo, "first\nline");
  error.AddLine("second\x1b");
  EXPECT_EQ(error.message, "first\\x0aline\n  second\\x1b");
}

TEST(FileName, StaysInItsFolder) {
  for (const char* name : {"plot1", "a.b", "A_b-c.d9", "x"}) EXPECT_TRUE(IsFileName(name)) << name;
  for (const std::string& text : test::HostileTexts()) {
    EXPECT_EQ(IsFileName(text), text == "plain") << text.substr(0, 50);
  }
  EXPECT_TRUE(IsFileName(std::string(100, 'a')));
  EXPECT_FALSE(IsFileName(std::string(101, 'a')));
  EXPECT_FALSE(IsFileName(".."));
  EXPECT_FALSE(IsFileName("gr\xc3\xbcn"));
}

}  // namespace
}  // namespace sextant
