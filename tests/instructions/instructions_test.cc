// SPDX-License-Identifier: Apache-2.0
// Kernels take no more instructions than the golden counts. Unlike times, instruction counts are
// the same in every run, so that a regression of a few percent shows.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <string_view>

#include "support/run_program.h"
#include "support/source_tree.h"

namespace sextant::test {
namespace {

// Per problem. Changes of code layout move the counts by less.
constexpr double kTolerance = 0.03;

struct Counts {
  std::string built;  // Compiler and instruction set of the kernels.
  std::map<std::string, double> per_problem;
};

std::filesystem::path GoldenPath() {
  return SourceRoot() / "tests" / "instructions" / "golden" / "instructions.json";
}

// Instructions of each dump by its name.
std::map<std::string, double> ReadDumps(const std::filesystem::path& folder) {
  const std::regex trigger("desc: Trigger: Client Request: (.*)");
  const std::regex totals("(?:totals|summary): ([0-9]+)");
  std::map<std::string, double> instructions;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (!entry.path().filename().string().starts_with("dump.")) continue;
    std::ifstream file(entry.path());
    std::string name;
    std::smatch match;
    for (std::string line; std::getline(file, line);) {
      if (std::regex_match(line, match, trigger)) name = match[1];
      if (!name.empty() && std::regex_match(line, match, totals)) {
        instructions[name] = std::stod(match[1]);
      }
    }
  }
  return instructions;
}

Counts CountInstructions() {
  const std::filesystem::path folder = TestFolder();
  const ProgramRun run =
      RunProgram(SEXTANT_VALGRIND, "--tool=callgrind --instr-atstart=no --callgrind-out-file=" +
                                       (folder / "dump").string() + " " SEXTANT_COUNT_INSTRUCTIONS);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  Counts counts;
  std::istringstream lines(run.out);
  std::getline(lines, counts.built);
  const std::map<std::string, double> dumps = ReadDumps(folder);
  int problems = 0;
  for (std::string name; lines >> name >> problems;) {
    EXPECT_TRUE(dumps.contains(name)) << name << " was not counted";
    if (dumps.contains(name)) counts.per_problem[name] = std::round(dumps.at(name) / problems);
  }
  return counts;
}

std::string Format(const Counts& counts) {
  nlohmann::ordered_json json = {{"built", counts.built}};
  for (const auto& [name, count] : counts.per_problem) {
    json["instructions"][name] = static_cast<long>(count);
  }
  return json.dump(1) + "\n";
}

TEST(Instructions, NoKernelExceedsItsGoldenCount) {
  if (std::string_view(SEXTANT_COUNT_INSTRUCTIONS).empty()) {
    GTEST_SKIP() << "valgrind was not found, or this is no release build";
  }
  const Counts now = CountInstructions();
  if (std::getenv("SEXTANT_UPDATE_GOLDEN") != nullptr) {
    WriteText(GoldenPath(), Format(now));
    return;
  }
  const auto golden = nlohmann::json::parse(ReadText(GoldenPath()), nullptr, false);
  ASSERT_TRUE(golden.is_object()) << "no golden counts: run scripts/update-instructions";
  if (golden.at("built") != now.built) {
    GTEST_SKIP() << "the counts are of " << golden.at("built") << ", this is " << now.built;
  }
  for (const auto& [name, count] : now.per_problem) {
    ASSERT_TRUE(golden.at("instructions").contains(name))
        << name << " is not among the golden counts: run scripts/update-instructions";
    const double before = golden.at("instructions").at(name).get<double>();
    EXPECT_LE(count, (1.0 + kTolerance) * before)
        << name << " takes " << 100.0 * (count / before - 1.0)
        << " percent more instructions; if that is worth it, run scripts/update-instructions and "
           "say why";
    if (count < (1.0 - kTolerance) * before) {
      std::printf("%s: %.0f instead of %.0f; scripts/update-instructions keeps the gain\n",
                  name.c_str(), count, before);
    }
  }
  EXPECT_EQ(golden.at("instructions").size(), now.per_problem.size());
}

}  // namespace
}  // namespace sextant::test
