// SPDX-License-Identifier: Apache-2.0
// Every format's escape with the same hostile texts: a reader of the format must see the text as
// PrintableLine gives it, and nothing else.
#include "base/text/escape.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "base/text/code_point.h"
#include "base/text/printable.h"
#include "io/text/yaml_node.h"
#include "support/hostile_text.h"

namespace sextant {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::vector<std::string>& Texts() { return test::HostileTexts(); }

TEST(Gnuplot, TheStringEndsWhereItShould) {
  for (const std::string& text : Texts()) {
    const std::string quoted = GnuplotText(text);
    ASSERT_TRUE(IsPlainLine(quoted));
    ASSERT_TRUE(quoted.size() >= 2 && quoted.front() == '"' && quoted.back() == '"');
    std::string read;
    for (std::size_t i = 1; i + 1 < quoted.size(); ++i) {
      ASSERT_TRUE(std::string_view("\"'`@$%{}0123456789").find(quoted[i]) == std::string_view::npos)
          << quoted;
      const bool is_number = quoted[i] == '\\';
      read +=
          is_number ? static_cast<char>(std::stoi(quoted.substr(i + 1, 3), nullptr, 8)) : quoted[i];
      if (is_number) i += 3;
    }
    EXPECT_EQ(read, PrintableLine(text));
  }
}

// What LaTeX shows of an escaped text. Fails the test for a special character that is not escaped.
std::string ShownByLatex(std::string_view latex) {
  static const std::map<std::string_view, char> kCommands = {{"\\textbackslash{}", '\\'},
                                                             {"\\textasciitilde{}", '~'},
                                                             {"\\textasciicircum{}", '^'},
                                                             {"\\textless{}", '<'},
                                                             {"\\textgreater{}", '>'},
                                                             {"\\textbar{}", '|'},
                                                             {"{[}", '['},
                                                             {"{*}", '*'},
                                                             {"\\_", '_'},
                                                             {"\\%", '%'},
                                                             {"\\&", '&'},
                                                             {"\\#", '#'},
                                                             {"\\$", '$'},
                                                             {"\\{", '{'},
                                                             {"\\}", '}'}};
  std::string shown;
  while (!latex.empty()) {
    const auto command = std::ranges::find_if(
        kCommands, [&](const auto& known) { return latex.starts_with(known.first); });
    if (command != kCommands.end()) {
      shown += command->second;
      latex.remove_prefix(command->first.size());
      continue;
    }
    EXPECT_EQ(std::string_view("\\_%&#${}~^<>|").find(latex.front()), std::string_view::npos)
        << latex.substr(0, 50);
    shown += latex.front();
    latex.remove_prefix(1);
  }
  return shown;
}

TEST(Latex, ShowsTheText) {
  for (const std::string& text : Texts()) {
    ASSERT_TRUE(IsPlainLine(LatexText(text)));
    EXPECT_EQ(ShownByLatex(LatexText(text)), PrintableLine(text));
  }
  EXPECT_EQ(LatexText("rms(a_b) [5 %]"), "rms(a\\_b) [5 \\%]") << "ordinary labels stay readable";
}

TEST(Markdown, HasNoMarkupOutsideOfCode) {
  for (const std::string& text : Texts()) {
    const std::string escaped = MarkdownText(text);
    ASSERT_TRUE(IsPlainLine(escaped));
    bool is_code = false;
    for (std::size_t i = 0; i < escaped.size(); ++i) {
      if (escaped[i] == '`') is_code = !is_code;
      if (escaped[i] == '\\') ++i;
      if (is_code) {
        EXPECT_NE(escaped[i], '|') << escaped;
        continue;
      }
      if (escaped[i] == '\\') continue;
      const bool begins_tag = escaped[i] == '<' && i + 1 < escaped.size() &&
                              (std::isalpha(static_cast<unsigned char>(escaped[i + 1])) != 0 ||
                               std::string_view("/!?").find(escaped[i + 1]) != std::string::npos);
      EXPECT_FALSE(begins_tag) << escaped;
    }
    EXPECT_FALSE(is_code) << "code does not end: " << escaped.substr(0, 50);
  }
}

TEST(Markdown, EscapesWhatWouldBeMarkup) {
  EXPECT_EQ(MarkdownText("[a](b) [c]: d"), "[a\\](b) [c\\]: d");
  EXPECT_EQ(MarkdownText("| a | b |"), "\\| a \\| b \\|");
  EXPECT_EQ(MarkdownText("`a|b` and ` alone"), "`a\\|b` and \\` alone");
  EXPECT_EQ(MarkdownText("<script>&lt;"), "&lt;script>&amp;lt;");
  EXPECT_EQ(MarkdownText("**b** _i_ ~~s~~ $x$"), "\\*\\*b\\*\\* \\_i\\_ \\~\\~s\\~\\~ \\$x\\$");
  EXPECT_EQ(MarkdownText("# a"), "\\# a");
  EXPECT_EQ(MarkdownText("- a"), "\\- a");
  EXPECT_EQ(MarkdownText("12. a"), "12\\. a");
}

TEST(Markdown, OrdinaryTextStays) {
  for (const char* text : {"-", "5.23 [4.91, 5.52]", "rms(rotation_deg,where=fine)", "95 %",
                           "outliers = 0.3, a < b", "-3.2", "ransac(kabsch, seed=3)", "+1",
                           "`joint` uses the raw observations", "corner error [mm], median"}) {
    EXPECT_EQ(MarkdownText(text), text);
  }
}

// The fields of one line of CSV by RFC 4180.
std::vector<std::string> ReadCsvLine(std::string_view line) {
  std::vector<std::string> fields = {""};
  bool is_quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && is_quoted && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += '"';
      ++i;
    } else if (line[i] == '"') {
      is_quoted = !is_quoted;
    } else if (line[i] == ',' && !is_quoted) {
      fields.emplace_back();
    } else {
      fields.back() += line[i];
    }
  }
  EXPECT_FALSE(is_quoted) << line.substr(0, 50);
  return fields;
}

TEST(Csv, TheFieldIsTheText) {
  for (const std::string& text : Texts()) {
    ASSERT_TRUE(IsPlainLine(CsvField(text)));
    const std::vector<std::string> fields = ReadCsvLine("a," + CsvField(text) + ",b");
    ASSERT_EQ(fields.size(), 3U) << text;
    std::string field = fields[1];
    const bool is_formula =
        text.size() > 1 && std::string_view("=+-@").find(text[0]) != std::string::npos;
    if (is_formula) {
      ASSERT_EQ(field.front(), '\'') << "a spreadsheet would compute it: " << text;
      field.erase(0, 1);
    }
    EXPECT_EQ(field, PrintableLine(text));
  }
}

TEST(Csv, NumbersStayNumbers) {
  for (const char* number : {"-0.5", "+3", "-1e-3", "0", "-", "nan"}) {
    EXPECT_EQ(CsvField(number), number);
  }
}

TEST(Yaml, TheScalarIsTheText) {
  for (const std::string& text : Texts()) {
    ASSERT_TRUE(IsPlainLine(YamlQuoted(text)));
    const Expected<YamlNode> root = ParseYaml("key: " + YamlQuoted(text) + "\n", "a.yaml");
    ASSERT_TRUE(root) << root.error().message;
    ASSERT_EQ(root->items.size(), 1U);
    EXPECT_EQ(root->items[0].text, PrintableLine(text));
  }
}

TEST(Json, TheStringIsTheText) {
  for (const std::string& text : Texts()) {
    const std::string json = JsonText({{"key", text}, {text, 1}});
    std::string line = json;
    std::erase(line, '\n');
    ASSERT_TRUE(IsPlainLine(line)) << line.substr(0, 100);
    const auto read = nlohmann::json::parse(json);
    const bool is_utf8 = text.find("invalid") != 0;
    if (is_utf8) {
      EXPECT_EQ(read["key"], text);
    }
  }
}

// What a browser shows of escaped text. Fails the test for a character that could be markup.
std::string ShownByBrowser(std::string_view html) {
  static const std::map<std::string_view, char> kEntities = {
      {"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&#39;", '\''}};
  std::string shown;
  for (std::size_t i = 0; i < html.size();) {
    EXPECT_TRUE(std::string_view("<>\"'").find(html[i]) == std::string_view::npos) << html;
    std::size_t bytes = 1;
    char c = html[i];
    if (c == '&') {
      bytes = html.find(';', i) + 1 - i;
      const auto entity = kEntities.find(html.substr(i, bytes));
      if (entity == kEntities.end()) return "not an entity";
      c = entity->second;
    }
    shown += c;
    i += bytes;
  }
  return shown;
}

TEST(Html, TheBrowserShowsTheText) {
  for (const std::string& text : Texts()) {
    ASSERT_TRUE(IsPlainLine(HtmlText(text)));
    EXPECT_EQ(ShownByBrowser(HtmlText(text)), PrintableLine(text));
  }
}

TEST(ScriptJson, NeitherEndsTheElementNorChangesTheText) {
  for (const std::string& text : Texts()) {
    const std::string json = ScriptJson({{"key", text}, {text, 1}});
    ASSERT_EQ(json.find_first_of("<>&"), std::string::npos) << json.substr(0, 100);
    const auto read = nlohmann::json::parse(json);
    const bool is_utf8 = text.find("invalid") != 0;
    if (is_utf8) {
      EXPECT_EQ(read["key"], text);
    }
  }
}

// The formats of a whole document leave line feeds to its writer alone.
TEST(Json, IndentsAsAsked) {
  EXPECT_EQ(JsonText({{"a", {1, 2}}}, 1), "{\n \"a\": [\n  1,\n  2\n ]\n}\n");
}

}  // namespace
}  // namespace sextant
