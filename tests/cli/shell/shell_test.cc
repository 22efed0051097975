// SPDX-License-Identifier: Apache-2.0
// The manual page and the completions, as man, bash and zsh read them.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "cli/shell/completion.h"
#include "cli/shell/manual_page.h"
#include "cli/shell/outline.h"
#include "support/run_program.h"

namespace sextant::cli {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Odd {
  std::string file{};
  std::string kind{};
  std::vector<double> numbers{};
  bool quick = false;
  std::string out{};
};

void DeclareOdd(Odd& options, Arguments& arguments) {
  arguments.Add("FILE", options.file, "A file", {.required = true});
  arguments.Add("--kind", options.kind, "It's [odd]: a \\ kind", {.choices = {"one", "two"}});
  arguments.Add("--numbers", options.numbers, ".starts with a full stop\n'and a quote");
  arguments.Add("--quick", options.quick, "A flag");
  arguments.Add("--out", options.out, "A file to write", {.writes = Writes::kFile});
}

int RunOdd(const Odd& /*options*/) { return 0; }

Program OddProgram() {
  Program program{
      .name = "odd", .version = "1", .introduction = "An odd one.", .footer = ".end", .groups = {}};
  Command parent{.name = "list", .summary = "A list", .footer = {}};
  parent.subcommands = {MakeCommand<Odd>("all", "All of it", "", DeclareOdd, RunOdd)};
  program.groups = {
      {"Group", {MakeCommand<Odd>("do-it", "Does it", "", DeclareOdd, RunOdd), parent}}};
  return program;
}

test::ProgramRun RunSextantIn(const std::string& shell, const std::string& script) {
  const std::string path = test::TestPath("script");
  test::WriteText(path, script);
  return test::RunProgram(shell, path);
}

// What bash offers after these words.
std::string Offered(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list += " '" + word + "'";
  const test::ProgramRun run =
      RunSextantIn("bash", "source <(" SEXTANT_BINARY " completion bash)\nCOMP_WORDS=(sextant" +
                               list + ")\nCOMP_CWORD=" + std::to_string(words.size()) +
                               "\n_sextant\necho \"${COMPREPLY[@]}\"\n");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, IsEmpty());
  return run.out;
}

TEST(Outline, HasEveryCommandWithItsArguments) {
  const std::vector<OutlinedCommand> all = Outline(OddProgram());
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].name, "do-it");
  EXPECT_EQ(all[2].name, "list all");
  ASSERT_EQ(all[0].positionals.size(), 1U);
  EXPECT_TRUE(all[0].positionals[0].required);
  std::vector<std::string> names;
  for (const OutlinedArgument& option : all[0].options) names.push_back(option.name);
  EXPECT_THAT(names,
              ElementsAre("--kind", "--numbers", "--quick", "--out", "--overwrite", "--help"));
  EXPECT_EQ(all[0].options[1].value, "NUMBER");
  EXPECT_TRUE(all[0].options[1].repeats);
  EXPECT_EQ(all[0].options[2].value, "");
}

TEST(BashCompletions, OfferCommandsOptionsChoicesAndFiles) {
  EXPECT_EQ(Offered({"cali"}), "calibrate\n");
  EXPECT_THAT(Offered({""}), AllOf(HasSubstr("solve"), HasSubstr("completion")));
  EXPECT_EQ(Offered({"list", "so"}), "solvers\n");
  EXPECT_EQ(Offered({"compare", "--solve"}), "--solvers\n");
  EXPECT_THAT(Offered({"simulate", "--"}), AllOf(HasSubstr("--overwrite"), HasSubstr("--scans")));
  EXPECT_EQ(Offered({"solve", "--json", test::TestPath("scr")}), test::TestPath("script") + "\n");
  EXPECT_EQ(Offered({"run", "x.yaml", "--trials", ""}), "\n");
  EXPECT_THAT(Offered({"--ver"}), HasSubstr("--version"));
}

TEST(ZshCompletions, AreReadByZsh) {
  const std::string script = ZshCompletion(OddProgram());
  EXPECT_THAT(script,
              AllOf(HasSubstr("#compdef odd"), HasSubstr("_odd_do_it()"),
                    HasSubstr("'do-it:Does it'"), HasSubstr("--kind"), HasSubstr("(one two)")));
  if (test::RunProgram("zsh", "--version").exit_code != 0) {
    GTEST_SKIP() << "zsh is not installed; the script is only checked as text";
  }
  // -n reads without running.
  test::WriteText(test::TestPath("_odd"), script);
  EXPECT_EQ(test::RunProgram("zsh", "-n " + test::TestPath("_odd")).err, "");
  const test::ProgramRun run =
      RunSextantIn("zsh", "autoload -Uz compinit && compinit -u -d " + test::TestPath("dump") +
                              "\n" + "source <(" SEXTANT_BINARY " completion zsh)\n" +
                              "print $+functions[_sextant_calibrate] "
                              "$+functions[_sextant_list_solvers] $_comps[sextant]\n");
  EXPECT_THAT(run.out, HasSubstr("1 1 _sextant")) << run.err;
}

TEST(ManualPages, HaveEveryCommandAndNoFaultForGroff) {
  const test::ProgramRun page = test::RunProgram(SEXTANT_BINARY, "manual");
  ASSERT_EQ(page.exit_code, 0);
  const std::string odd = ManualPage(OddProgram());
  EXPECT_THAT(odd, AllOf(HasSubstr("\\&.starts"), HasSubstr("\\&'and"), HasSubstr("a \\e kind")));
  const std::string path = test::TestPath("sextant.1");
  test::WriteText(path, page.out);
  test::WriteText(test::TestPath("odd.1"), odd);
  if (test::RunProgram("groff", "--version").exit_code != 0) {
    GTEST_SKIP() << "groff is not installed; the page is only checked as text";
  }
  EXPECT_EQ(test::RunProgram("groff", "-man -ww -z " + test::TestPath("odd.1")).err, "");
  const test::ProgramRun read = test::RunProgram("groff", "-man -ww -Tascii -P-cbou " + path);
  EXPECT_THAT(read.err, IsEmpty());
  for (const char* text : {"sextant calibrate", "--image-topic", "sextant list solvers", "NAME"}) {
    EXPECT_THAT(read.out, HasSubstr(text));
  }
}

}  // namespace
}  // namespace sextant::cli
