// SPDX-License-Identifier: Apache-2.0
#include "cli/parse.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/output.h"

namespace sextant::cli {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

struct Everything {
  std::string file{};
  std::string name = "kabsch";
  std::string parent{};
  bool quick = false;
  int trials = 7;
  std::uint64_t seed = 1;
  double sigma = 0.5;
  std::optional<int> id{};
  std::optional<std::uint64_t> other_seed{};
  std::optional<double> growth{};
  std::vector<int> ids{};
  std::vector<double> region{};
  std::vector<std::string> models{};
  std::vector<std::string> pose{};
  std::string direction{};
  GivenOptions given{};
};

void Declare(Everything& options, Arguments& arguments) {
  arguments.Add("FILE", options.file, "A file", {.required = true});
  arguments.Add("--name", options.name, "A name", {.shows_default = true});
  arguments.Add("--parent", options.parent, "A parent", {.choices = {"lidar", "camera"}});
  arguments.Add("--quick", options.quick, "A flag");
  arguments.Add("--trials", options.trials, "A count",
                {.shows_default = true, .range = {{0, 1000}}});
  arguments.Add("--seed", options.seed, "A seed", {.range = {{1, 1e9}}});
  arguments.Add("--sigma", options.sigma, "A length [m]", {.range = {{0.001, 100.0}}});
  arguments.Add("--id", options.id, "An id");
  arguments.Add("--other-seed", options.other_seed, "Another seed");
  arguments.Add("--growth", options.growth, "A growth", {.range = {{0.0, 1.0}}});
  arguments.Add("--ids", options.ids, "Many ids");
  arguments.Add("--region", options.region, "Six numbers", {.min_values = 6});
  arguments.Add("--models", options.models, "A list", {.separator = ','});
  arguments.Add("--pose", options.pose, "One to seven values",
                {.min_values = 1, .max_values = 7, .excludes = "--name"});
  arguments.Add("--direction", options.direction, "Of the pose", {.needs = "--pose"});
  arguments.ReportGiven(options.given);
}

// The options that the last run was given.
Everything& Seen() {
  static Everything seen;
  return seen;
}

int Run(const Everything& options) {
  Seen() = options;
  return 5;
}

struct OptionalFile {
  std::string file{};
};

void DeclareFile(OptionalFile& options, Arguments& arguments) {
  arguments.Add("FILE", options.file, "A file, optional because there is a subcommand");
}

int RunFile(const OptionalFile& options) { return options.file == "a.txt" ? 5 : -1; }

Program TestedProgram() {
  const auto fixed = [](std::string name, int code) {
    return Command{.name = std::move(name),
                   .summary = "Returns a number",
                   .footer = "Example: of a subcommand",
                   .run = [code] { return code; }};
  };
  Command simulate =
      MakeCommand<OptionalFile>("simulate", "Has a subcommand", "", DeclareFile, RunFile);
  simulate.subcommands = {fixed("pairs", 6)};
  const Command list{.name = "list",
                     .summary = "Needs a subcommand",
                     .footer = "",
                     .subcommands = {fixed("solvers", 7), fixed("lidars", 8)}};
  return {.name = "sextant",
          .introduction = "The introduction",
          .footer = "The footer",
          .groups = {{"First group",
                      {MakeCommand<Everything>("all", "Has every kind of option", "Example: all",
                                               Declare, Run)}},
                     {"Second group", {simulate, list}}},
          .renamed = {{"solvers", "list solvers"}}};
}

ParsedLine Parse(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "sextant");
  return ParseLine(TestedProgram(), static_cast<int>(arguments.size()), arguments.data());
}

int RunLine(const std::vector<const char*>& arguments) {
  const ParsedLine line = Parse(arguments);
  EXPECT_TRUE(line.run) << line.err;
  return line.run ? line.run() : line.exit_code;
}

std::string ErrorOf(const std::vector<const char*>& arguments) {
  const ParsedLine line = Parse(arguments);
  EXPECT_FALSE(line.run);
  EXPECT_EQ(line.exit_code, kWrongUse);
  EXPECT_EQ(line.out, "");
  return line.err;
}

TEST(Parse, SetsOptionsOfEveryType) {
  EXPECT_EQ(
      RunLine({"all",      "a.txt",        "--name", "gnc",      "--parent", "camera", "--quick",
               "--trials", "1000",         "--seed", "12345678", "--sigma",  "0.25",   "--id",
               "-3",       "--other-seed", "9",      "--growth", "0.5",      "--ids",  "4",
               "5",        "--region",     "0",      "1",        "2",        "3",      "4",
               "5",        "--models",     "a,b"}),
      5);
  const Everything& seen = Seen();
  EXPECT_EQ(seen.file, "a.txt");
  EXPECT_EQ(seen.name, "gnc");
  EXPECT_EQ(seen.parent, "camera");
  EXPECT_TRUE(seen.quick);
  EXPECT_EQ(seen.trials, 1000);
  EXPECT_EQ(seen.seed, 12345678U);
  EXPECT_EQ(seen.sigma, 0.25);
  EXPECT_EQ(seen.id, -3);
  EXPECT_EQ(seen.other_seed, 9U);
  EXPECT_EQ(seen.growth, 0.5);
  EXPECT_THAT(seen.ids, ElementsAre(4, 5));
  EXPECT_THAT(seen.region, ElementsAre(0.0, 1.0, 2.0, 3.0, 4.0, 5.0));
  EXPECT_THAT(seen.models, ElementsAre("a", "b"));
}

// CLI11 2.1 writes a default as "=7", 2.4 as "[7]".
auto ShowsDefault(const std::string& option, const std::string& value) {
  return AllOf(HasSubstr(option), AnyOf(HasSubstr("=" + value), HasSubstr("[" + value + "]")));
}

TEST(Parse, KeepsDefaults) {
  EXPECT_EQ(RunLine({"all", "a.txt"}), 5);
  const Everything& seen = Seen();
  EXPECT_EQ(seen.name, "kabsch");
  EXPECT_EQ(seen.trials, 7);
  EXPECT_EQ(seen.seed, 1U);
  EXPECT_FALSE(seen.quick || seen.id || seen.other_seed || seen.growth);
  EXPECT_TRUE(seen.ids.empty() && seen.models.empty() && seen.pose.empty());
}

TEST(Parse, ChoicesAreReadInAnyCase) {
  EXPECT_EQ(RunLine({"all", "a.txt", "--parent", "LiDAR"}), 5);
  EXPECT_EQ(Seen().parent, "lidar");
}

TEST(Parse, RefusesValuesThatTheRulesForbid) {
  EXPECT_THAT(ErrorOf({"all"}), HasSubstr("FILE is required"));
  EXPECT_THAT(ErrorOf({"all", "a", "--trials", "1001"}),
              AllOf(HasSubstr("--trials"), HasSubstr("1000")));
  EXPECT_THAT(ErrorOf({"all", "a", "--trials", "1.5"}), HasSubstr("--trials"));
  EXPECT_THAT(ErrorOf({"all", "a", "--seed", "0"}), HasSubstr("--seed"));
  EXPECT_THAT(ErrorOf({"all", "a", "--sigma", "0"}), HasSubstr("--sigma"));
  EXPECT_THAT(ErrorOf({"all", "a", "--growth", "2"}), HasSubstr("--growth"));
  EXPECT_THAT(ErrorOf({"all", "a", "--parent", "radar"}), HasSubstr("--parent"));
  EXPECT_THAT(ErrorOf({"all", "a", "--region", "1", "2"}), HasSubstr("--region"));
  EXPECT_THAT(ErrorOf({"all", "a", "--pose", "1", "--name", "b"}), HasSubstr("excludes"));
  EXPECT_THAT(ErrorOf({"all", "a", "--unknown"}), HasSubstr("--unknown"));
}

TEST(Parse, RefusesAnOptionWithoutTheOneThatItIsAbout) {
  EXPECT_EQ(ErrorOf({"all", "a", "--direction", "up"}),
            "sextant all: --direction has no effect without --pose: add --pose, or leave "
            "--direction out\n");
  EXPECT_EQ(RunLine({"all", "a", "--direction", "up", "--pose", "1"}), 5);
}

TEST(Parse, RefusesWhatABareCommandWouldTakeBeforeASubcommand) {
  EXPECT_THAT(ErrorOf({"simulate", "a.txt", "pairs"}),
              AllOf(HasSubstr("FILE does not go before pairs"),
                    HasSubstr("sextant simulate pairs --help")));
}

TEST(Parse, TellsAGivenValueFromADefault) {
  EXPECT_EQ(RunLine({"all", "a", "--name", "kabsch", "--quick"}), 5);
  EXPECT_THAT(Seen().given, ElementsAre("FILE", "--name", "--quick")) << "kabsch is the default";
  EXPECT_EQ(RunLine({"all", "a"}), 5);
  EXPECT_THAT(Seen().given, ElementsAre("FILE"));
}

TEST(Parse, NamesTheFirstGivenOptionThatHasNoEffect) {
  const GivenOptions given = {"FILE", "--seed", "--name"};
  EXPECT_TRUE(RefuseGiven(given, {"--quick", "--trials"}, "is for others"));
  const Expected<void> refused =
      RefuseGiven(given, {"--quick", "--name", "--seed"}, "is for others");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "--name is for others; leave it out");
}

TEST(Parse, SuggestsTheOptionThatIsMeant) {
  EXPECT_EQ(ErrorOf({"all", "a.txt", "--trails", "3"}),
            "sextant all has no option '--trails'; did you mean --trials? Or see 'sextant all "
            "--help'\n");
  EXPECT_EQ(ErrorOf({"all", "--sed=3"}),
            "sextant all has no option '--sed'; did you mean --seed? Or see 'sextant all --help'\n")
      << "FILE is missing too";
  EXPECT_EQ(ErrorOf({"list", "lidars", "--nothing-like-it"}),
            "sextant list lidars has no option '--nothing-like-it'; see 'sextant list lidars "
            "--help'\n");
  EXPECT_EQ(ErrorOf({"all", "a.txt", "b.txt"}),
            "sextant all: unexpected argument 'b.txt'; see 'sextant all --help'\n");
  EXPECT_THAT(ErrorOf({"all", "a.txt", "--\x1b[31m"}), HasSubstr("'--\\x1b[31m'"));
}

TEST(Parse, RefusesWhatIsNoFiniteNumber) {
  for (const char* text : {"nan", "NaN", "-nan", "inf", "-inf", "1e999", "1x", "x", "", "0x1p3"}) {
    EXPECT_THAT(ErrorOf({"all", "a", "--sigma", text}), HasSubstr("--sigma: expected a finite"));
    EXPECT_THAT(ErrorOf({"all", "a", "--growth", text}), HasSubstr("--growth"));
    EXPECT_THAT(ErrorOf({"all", "a", "--region", "1", "2", "3", "4", "5", text}),
                HasSubstr("--region: expected a finite"));
  }
  for (const char* text : {"-1", "1.5", "18446744073709551616", "1e3", "nan", ""}) {
    EXPECT_THAT(ErrorOf({"all", "a", "--other-seed", text}),
                HasSubstr("--other-seed: expected a whole number from 0 to 18446744073709551615"));
    EXPECT_THAT(ErrorOf({"all", "a", "--seed", text}),
                HasSubstr("--seed: expected a whole number from 1 to 1"));
  }
  EXPECT_THAT(ErrorOf({"all", "a", "--ids", "1", "2147483648"}), HasSubstr("--ids"));
  EXPECT_THAT(ErrorOf({"all", "a", "--sigma", "5000"}),
              HasSubstr("expected a finite number from 0.001 to 100, got '5000'"));
}

TEST(Parse, RefusesEmptyTexts) {
  EXPECT_THAT(ErrorOf({"all", ""}), HasSubstr("expected a text, got an empty one"));
  EXPECT_THAT(ErrorOf({"all", "a", "--name", ""}), HasSubstr("--name"));
  EXPECT_THAT(ErrorOf({"all", "a", "--models", "a", ""}), HasSubstr("--models"));
}

TEST(Parse, RunsTheSubcommandThatIsNamed) {
  EXPECT_EQ(RunLine({"simulate", "a.txt"}), 5);
  EXPECT_EQ(RunLine({"simulate", "pairs"}), 6);
  EXPECT_EQ(RunLine({"list", "solvers"}), 7);
  EXPECT_EQ(RunLine({"list", "lidars"}), 8);
}

TEST(Parse, NamesTheCommandThatIsMeant) {
  EXPECT_EQ(ErrorOf({"simulat"}), "sextant has no command 'simulat'; did you mean 'simulate'?\n");
  EXPECT_EQ(ErrorOf({"list", "solver"}),
            "sextant list has no command 'solver'; did you mean 'solvers'?\n");
  EXPECT_EQ(ErrorOf({"solvers", "ransac"}), "'sextant solvers' is now 'sextant list solvers'\n");
  EXPECT_THAT(ErrorOf({}), HasSubstr("subcommand is required"));
  EXPECT_THAT(ErrorOf({"list"}), HasSubstr("subcommand is required"));
}

TEST(Parse, HelpShowsGroupsOptionsAndExamples) {
  const ParsedLine top = Parse({"--help"});
  EXPECT_FALSE(top.run);
  EXPECT_EQ(top.exit_code, 0);
  EXPECT_THAT(top.out, AllOf(HasSubstr("The introduction"), HasSubstr("First group:"),
                             HasSubstr("Second group:"), HasSubstr("Has every kind of option"),
                             HasSubstr("The footer"), Not(HasSubstr("--region"))));
  const ParsedLine all = Parse({"all", "--help"});
  EXPECT_THAT(all.out, AllOf(ShowsDefault("--name TEXT", "kabsch"), HasSubstr("A length [m]"),
                             ShowsDefault("--trials INT", "7"), HasSubstr("Example: all")));
  EXPECT_THAT(Parse({"list", "--help"}).out, HasSubstr("solvers"));
  EXPECT_THAT(Parse({"list", "lidars", "--help"}).out, HasSubstr("Example: of a subcommand"));
  EXPECT_THAT(Parse({"--help-all"}).out, AllOf(HasSubstr("--region"), HasSubstr("lidars")));
}

}  // namespace
}  // namespace sextant::cli
