// SPDX-License-Identifier: Apache-2.0
#include "cli/run_program.h"

#include <gtest/gtest.h>

#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/call_files.h"
#include "cli/output.h"
#include "support/run_program.h"

namespace sextant::cli {
namespace {

struct NoOptions {};

void DeclareNothing(NoOptions&, Arguments&) {}

struct PathOptions {
  std::string out{};
};

void DeclarePath(PathOptions& options, Arguments& arguments) {
  arguments.Add("--out", options.out, "A file", {.writes = Writes::kFile});
}

template <class Exception>
int Throw(const NoOptions&) {
  throw Exception();
}

struct Unexpected : std::runtime_error {
  Unexpected() : std::runtime_error("unexpected") {}
};

Program ProgramOfFaults() {
  Command all{.name = "group", .summary = "A group", .footer = {}};
  all.subcommands = {
      MakeCommand<NoOptions>("memory", "", "", DeclareNothing, Throw<std::bad_alloc>),
      MakeCommand<NoOptions>("fault", "", "", DeclareNothing, Throw<Unexpected>),
      MakeCommand<PathOptions>("path", "", "", DeclarePath, [](const PathOptions&) {
        return CallFiles::Current()->may_overwrite() ? 40 : 41;
      })};
  return {.name = "tested", .introduction = {}, .footer = {}, .groups = {{"Commands", {all}}}};
}

int RunWith(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), {"tested", "group"});
  return RunProgram(ProgramOfFaults(), static_cast<int>(arguments.size()), arguments.data());
}

TEST(RunProgram, NoExceptionLeavesIt) {
  EXPECT_EQ(RunWith({"memory"}), kFailed);
  EXPECT_EQ(RunWith({"fault"}), kFailed);
}

TEST(RunProgram, OutputsAreCheckedBeforeTheCommandRuns) {
  const std::string path = test::TestPath("file");
  EXPECT_EQ(RunWith({"path"}), 41);
  EXPECT_EQ(RunWith({"path", "--out", path.c_str()}), 41);
  EXPECT_EQ(RunWith({"path", "--out", ""}), kWrongUse);
  EXPECT_EQ(RunWith({"path", "--out", "-"}), kWrongUse);
  EXPECT_EQ(RunWith({"path", "--out", (path + "/absent/x").c_str()}), kNotWritten);
  test::WriteText(path, "foreign");
  EXPECT_EQ(RunWith({"path", "--out", path.c_str()}), kWrongUse);
  EXPECT_EQ(RunWith({"path", "--overwrite", "--out", path.c_str()}), 40);
  EXPECT_EQ(RunWith({"memory", "--overwrite"}), kWrongUse) << "it writes nothing";
  EXPECT_EQ(CallFiles::Current(), nullptr);
}

}  // namespace
}  // namespace sextant::cli
