// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <filesystem>
#include <map>
#include <sstream>
#include <string>

#include "e2e/run_sextant.h"
#include "support/run_program.h"
#include "support/source_tree.h"

namespace sextant {
namespace {

using test::ProgramRun;
using test::ReadText;
using test::RunSextant;
using test::TestFolder;
using test::TestPath;
using test::WriteText;
using testing::HasSubstr;

constexpr const char* kExperiment = R"(title: Points
kind: random_scene
trials: 200
quick_trials: 40
parameters: {data: points, pairs: 8, sigma_m: 0.01}
solvers: [kabsch, mean_offset]
tables:
  - columns: [median(translation_mm)]
)";

constexpr const char* kLog = R"(kind: average_log
trials: 1
parameters: {log: nowhere/avg_values.txt}
)";

constexpr const char* kClaims = R"(paper: a paper
experiments: [points, log]
claims:
  - {id: exact, where: Table 1, text: Kabsch is off by a metre, printed: 1 m, value: 1000, rule: at_least, unit: mm,
     ours: {experiment: points, subject: kabsch, statistic: median(translation_mm)}}
  - {id: close, where: Table 1, text: Kabsch is off by centimetres, printed: 1 cm, value: 10, rule: draw, unit: mm,
     ours: {experiment: points, subject: kabsch, statistic: median(translation_mm)}}
  - {id: better, where: Table 2, text: Kabsch is better than the mean offset, printed: '-', rule: less, unit: mm,
     ours: {experiment: points, subject: kabsch, statistic: median(translation_mm)}, than: {experiment: points, subject: mean_offset, statistic: median(translation_mm)}}
  - {id: logged, where: Figure 1, text: a log, printed: 3 mm, value: 3, rule: draw,
     ours: {experiment: log, subject: true mean, index: 1, statistic: mean(from_mean_mm)}}
errata:
  - {where: Equation 1, printed: f twice, is: f once}
)";

std::string Arguments(const char* out) {
  std::filesystem::create_directories(TestFolder() / "experiments");
  WriteText(TestFolder() / "experiments" / "points.yaml", kExperiment);
  WriteText(TestFolder() / "experiments" / "log.yaml", kLog);
  WriteText(TestPath("claims.yaml"), kClaims);
  return "reproduce --experiments " + TestPath("experiments") + " --claims " +
         TestPath("claims.yaml") + " --out " + TestPath(out);
}

TEST(Reproduce, JudgesEveryClaimOnOnePage) {
  const ProgramRun run = RunSextant(Arguments("paper"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("4 claims"));
  EXPECT_THAT(run.err, HasSubstr("the real data is absent"));
  const std::string page = ReadText(TestFolder() / "paper" / "REPRODUCTION.md");
  EXPECT_THAT(page, HasSubstr("4 claims: 1 reproduced, 1 direction reproduced, 1 refuted, 1 not "
                              "testable."));
  EXPECT_THAT(page, HasSubstr("| Equation 1 | f twice | f once |"));
  EXPECT_TRUE(std::filesystem::exists(TestFolder() / "paper" / "points" / "report.md"));
}

TEST(Reproduce, ContinuesWhereItWasAndGivesTheSamePage) {
  ASSERT_EQ(RunSextant(Arguments("one") + " --quick --threads 1").exit_code, 0);
  const std::string page = ReadText(TestFolder() / "one" / "REPRODUCTION.md");
  EXPECT_THAT(page, HasSubstr("sextant reproduce --quick"));
  ASSERT_EQ(RunSextant(Arguments("one") + " --quick").exit_code, 0);
  EXPECT_EQ(ReadText(TestFolder() / "one" / "REPRODUCTION.md"), page);
  ASSERT_EQ(RunSextant(Arguments("two") + " --quick --threads 2").exit_code, 0);
  EXPECT_EQ(ReadText(TestFolder() / "two" / "REPRODUCTION.md"), page);
}

// One trial in six is outside the range of ten others, which is no reason to refute.
TEST(Reproduce, FewTrialsDoNotRefuteASingleMeasurement) {
  const std::string arguments = Arguments("paper");
  std::string experiment = kExperiment;
  experiment.replace(experiment.find("quick_trials: 40"), 16, "quick_trials: 10");
  WriteText(TestFolder() / "experiments" / "points.yaml", experiment);
  ASSERT_EQ(RunSextant(arguments + " --quick").exit_code, 0);
  EXPECT_THAT(ReadText(TestFolder() / "paper" / "REPRODUCTION.md"),
              HasSubstr("4 claims: 1 direction reproduced, 1 refuted, 1 undecided with this "
                        "number of trials, 1 not testable."));
}

TEST(Reproduce, ReportsWhatIsWrong) {
  const std::string arguments = Arguments("paper");
  std::string claims = kClaims;
  claims.replace(claims.find("subject: kabsch"), 15, "subject: kabsh ");
  WriteText(TestPath("claims.yaml"), claims);
  const ProgramRun unknown = RunSextant(arguments + " --quick");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("exact: points has no subject 'kabsh'"));
  const ProgramRun absent =
      RunSextant("reproduce --claims " + TestPath("nowhere.yaml") + " --out " + TestPath("paper"));
  EXPECT_EQ(absent.exit_code, 2);
  EXPECT_THAT(absent.err, HasSubstr("nowhere.yaml"));
}

// The verdicts of the page, by place, claim and printed value.
std::map<std::string, std::string> VerdictsOf(const std::filesystem::path& page) {
  std::map<std::string, std::string> verdicts;
  std::istringstream lines(ReadText(page));
  for (std::string line; std::getline(lines, line);) {
    std::size_t ours = 0;
    for (int bar = 0; bar < 3 && ours != std::string::npos; ++bar) ours = line.find("| ", ours + 1);
    const std::size_t verdict = line.find("| **");
    if (ours == std::string::npos || verdict == std::string::npos) continue;
    verdicts[line.substr(0, ours)] =
        line.substr(verdict + 4, line.find("**", verdict + 4) - verdict - 4);
  }
  return verdicts;
}

// The claims, without the experiments that no claim is about: those are for readers.
std::string WithoutUnclaimed(std::string claims) {
  const std::string before = "experiments: [";
  const std::size_t begin = claims.find(before) + before.size();
  const std::size_t end = claims.find(']', begin);
  std::string kept;
  std::istringstream names(claims.substr(begin, end - begin));
  for (std::string name; names >> name;) {
    if (name.ends_with(',')) name.pop_back();
    if (claims.find("{experiment: " + name + ",") == std::string::npos) continue;
    kept += (kept.empty() ? "" : ", ") + name;
  }
  return claims.replace(begin, end - begin, kept);
}

// The quick run judges every claim that paper/ judges, and contradicts none.
TEST(Reproduce, QuicklyAgreesWithThePageOfTheFullRun) {
  const std::filesystem::path root = test::SourceRoot();
  WriteText(TestPath("claims.yaml"), WithoutUnclaimed(ReadText(root / "paper" / "claims.yaml")));
  const ProgramRun run =
      RunSextant("reproduce --quick --experiments " + (root / "experiments").string() +
                 " --claims " + TestPath("claims.yaml") + " --out " + TestPath("paper"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto full = VerdictsOf(root / "paper" / "REPRODUCTION.md");
  const auto quick = VerdictsOf(TestFolder() / "paper" / "REPRODUCTION.md");
  EXPECT_GT(full.size(), 50u);
  EXPECT_EQ(full.size(), quick.size());
  for (const auto& [claim, verdict] : full) {
    ASSERT_TRUE(quick.contains(claim)) << claim << ": run `sextant reproduce` and commit paper/";
    const std::string& now = quick.at(claim);
    EXPECT_FALSE(verdict == "refuted" && now.ends_with("reproduced")) << claim;
    EXPECT_FALSE(verdict.ends_with("reproduced") && now == "refuted") << claim;
  }
}

}  // namespace
}  // namespace sextant
