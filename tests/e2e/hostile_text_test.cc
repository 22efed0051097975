// SPDX-License-Identifier: Apache-2.0
// Texts of hostile files and arguments, through the program as users run it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "base/process/run_process.h"
#include "base/text/code_point.h"
#include "e2e/run_sextant.h"
#include "support/run_program.h"

namespace sextant::test {
namespace {

using testing::HasSubstr;

bool IsSafeText(std::string text) {
  std::erase(text, '\n');
  return IsPlainLine(text);
}

// Arguments as they are, without a shell.
ProgramRun RunWith(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), SEXTANT_BINARY);
  const Expected<ProcessEnd> end = RunProcess(arguments);
  EXPECT_TRUE(end) << end.error().message;
  return end ? ProgramRun{end->exit_code, end->out, end->err} : ProgramRun{};
}

// A small experiment with `lines` in its middle.
std::filesystem::path WriteHostile(const std::string& lines, const std::string& more = "") {
  const std::filesystem::path path = TestFolder() / "hostile.yaml";
  WriteText(path, "kind: random_scene\ntrials: 20\n" + lines +
                      "\nparameters: {data: points}\nsolvers: [kabsch]\ngrid: {pairs: [4, 8]}\n" +
                      more + "\n");
  return path;
}

// No file outside of `out` appeared, nowhere in the test's folder a file named owned.
void ExpectNothingOwned() {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(TestFolder())) {
    EXPECT_EQ(entry.path().string().find("owned"), std::string::npos) << entry.path();
  }
  EXPECT_FALSE(std::filesystem::exists("owned"));
}

TEST(HostileExperiment, ATitleOfSeveralLinesIsRefusedWithItsPlace) {
  for (const char* field : {"title", "x_label", "y_label"}) {
    const auto path = WriteHostile("", "plots:\n  - {name: p, x: pairs, y: rate(success),\n     " +
                                           std::string(field) + ": \"S\\n!touch owned\\n#\"}");
    const ProgramRun run = RunWith({"run", path, "--out", TestFolder() / "out"});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_THAT(run.err, HasSubstr("hostile.yaml:9: " + std::string(field) +
                                   ": expected text of one line, got 'S\\x0a!touch owned"));
    EXPECT_FALSE(std::filesystem::exists(TestFolder() / "out"));
    ExpectNothingOwned();
  }
}

TEST(HostileExperiment, ControlCharactersAreRefusedWithTheirPlace) {
  for (const char* text :
       {"\\x1b[31m", "\\x07", "\\x7f", "\\x9b", "\\u202e", "\\u2066", "\\u2028"}) {
    const auto path = WriteHostile("text: \"a " + std::string(text) + "\"");
    const ProgramRun run = RunWith({"run", path, "--out", TestFolder() / "out"});
    EXPECT_EQ(run.exit_code, 2) << text;
    EXPECT_THAT(run.err, HasSubstr("hostile.yaml:3"));
    EXPECT_THAT(run.err, HasSubstr("text: control characters are not allowed"));
    EXPECT_TRUE(IsSafeText(run.err)) << run.err;
  }
}

TEST(HostileExperiment, NamesOfFilesStayInTheFolder) {
  for (const char* name : {"../../x", "/tmp/x", ".hidden", "-rf", "a b", "a/b", "", "x;y"}) {
    const auto plot = WriteHostile(
        "", "plots:\n  - {x: pairs, y: rate(success), name: '" + std::string(name) + "'}");
    const ProgramRun run = RunWith({"run", plot, "--out", TestFolder() / "out"});
    EXPECT_EQ(run.exit_code, 2) << name;
    EXPECT_THAT(run.err, HasSubstr("hostile.yaml:8: name: expected a name for a file: "));
    const auto experiment = WriteHostile("name: '" + std::string(name) + "'");
    const ProgramRun second = RunWith({"run", experiment, "--out", TestFolder() / "out"});
    EXPECT_EQ(second.exit_code, 2) << name;
    EXPECT_THAT(second.err, HasSubstr("hostile.yaml:3: name: expected a name for a file: "));
  }
}

// Texts of one line pass, and are text in every output.
TEST(HostileExperiment, EveryOutputEscapesTexts) {
  const std::string text =
      "x' \\\\ `touch owned` $(touch owned) %s {/Bold y}_a^b @c &d ~e # <script>alert(1)</script> "
      "]]> | [l](http://x) -- \\\"q\\\"";
  const std::string hostile = "\"" + text + "\"";
  const auto path =
      WriteHostile("title: " + hostile + "\ntext: " + hostile,
                   "conditions:\n  - {name: " + hostile +
                       "}\n  - {name: \"=1+1,b\"}\ntables:\n  - {title: " + hostile +
                       ", columns: [rate(success)], labels: [" + hostile +
                       "]}\nplots:\n  - {name: p, x: pairs, y: rate(success), title: " + hostile +
                       ", x_label: " + hostile + ", y_label: " + hostile + "}");
  const auto out = TestFolder() / "out";
  const ProgramRun run = RunWith({"run", path, "--out", out});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(IsSafeText(run.out + run.err));
  ExpectNothingOwned();
  for (const char* name : {"rows.csv", "summary.json", "report.md", "tables.tex"}) {
    EXPECT_TRUE(IsSafeText(ReadText(out / name))) << name;
  }
  EXPECT_THAT(ReadText(out / "report.md"), HasSubstr("&lt;script>"));
  EXPECT_THAT(ReadText(out / "tables.tex"), HasSubstr("\\textbackslash{} `touch owned` \\$("));
  EXPECT_THAT(ReadText(out / "rows.csv"), HasSubstr(",\"'=1+1,b, pairs=4\","));
  EXPECT_THAT(ReadText(out / "p.svg"), HasSubstr("&lt;script>"));
  EXPECT_THAT(ReadText(out / "p.svg"), HasSubstr("]]&gt;"));
  const auto json = nlohmann::json::parse(ReadText(out / "summary.json"));
  EXPECT_THAT(json["title"].get<std::string>(), HasSubstr("<script>alert(1)</script> ]]>"));
}

TEST(HostileArguments, PlotsMayHaveAnyName) {
  const std::string pairs = TestPath("pairs.yaml");
  ASSERT_EQ(RunWith({"simulate", "pairs", "--out", pairs}).exit_code, 0);
  for (const char* name :
       {"it's.svg", "a b.png", "a\n!touch owned\n.svg", "`touch owned`.svg", "$(touch owned).svg",
        "%s\\n.svg", "\x1b[31m.svg", "\xff.svg", "-x.svg"}) {
    const auto plot = TestFolder() / name;
    const ProgramRun run = RunWith({"compare", pairs, "--solvers", "kabsch", "--plot", plot});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_TRUE(std::filesystem::exists(plot)) << name;
    std::filesystem::remove(plot);
  }
  ExpectNothingOwned();
}

TEST(HostileArguments, MessagesQuoteThemSafely) {
  const std::string bad = "a\n\x1b[31m\x07\xc2\x9b\xe2\x80\xae\xff";
  const std::vector<std::vector<std::string>> lines = {
      {bad},
      {"list", bad},
      {"list", "solvers", bad},
      {"solve", bad},
      {"solve", "--" + bad},
      {"compare", TestPath("none"), "--solvers", bad},
      {"calibrate", bad},
      {"calibrate", "--image", bad, "--cloud", bad, "--board", bad, "--camera", bad},
      {"detect", bad},
      {"detect", bad, "--detector", bad},
      {"boards", bad, "--board", bad},
      {"run", bad},
      {"export", bad, "--to", bad},
      {"bag", bad},
      {"advise", bad, "--picture", bad + ".png"},
      {"report", bad, "--out", bad},
      {"simulate", bad, "--out", bad},
      {"simulate", "pairs", "--out", bad + "/x"},
      {"print-board", bad, "--out", bad},
      {"convert", bad, bad},
      {"fuse", bad, bad, "--out", bad},
      {"average", bad},
      {"project", "--image", bad, "--cloud", bad, "--result", bad, "--out", bad},
      {"mark", "--cloud", bad, "--render", bad},
      {"merge", bad, bad},
      {"reproduce", "--claims", bad},
      {"calibrate", "x", "--tolerance", bad},
  };
  for (const std::vector<std::string>& line : lines) {
    const ProgramRun run = RunWith(line);
    EXPECT_NE(run.exit_code, 0) << line[0];
    EXPECT_LT(run.exit_code, 100) << line[0] << ": " << run.err;
    EXPECT_TRUE(IsSafeText(run.out + run.err)) << line[0] << ": " << run.out << run.err;
  }
}

}  // namespace
}  // namespace sextant::test
