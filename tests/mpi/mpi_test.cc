// SPDX-License-Identifier: Apache-2.0
// `mpirun sextant-mpi run` as users run it, and the job scripts of Slurm without Slurm.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "support/run_program.h"
#include "support/source_tree.h"

namespace sextant::test {
namespace {

using testing::HasSubstr;
using testing::MatchesRegex;

// The sanitizer looks for leaks at the end, when OpenMPI's modules, which have some, are unloaded.
constexpr const char* kAsRootOnOneCore =
    "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
    "OMPI_MCA_rmaps_base_oversubscribe=1 ASAN_OPTIONS=detect_leaks=0 ";

std::string Quoted(const std::filesystem::path& path) { return "'" + path.string() + "'"; }

std::filesystem::path WriteExperiment(int trials) {
  std::filesystem::path path = TestFolder() / "small.yaml";
  WriteText(path, "title: A small one\nkind: random_scene\ntrials: " + std::to_string(trials) +
                      "\nparameters: {data: points}\nsolvers: [kabsch, 'ransac(kabsch, seed=3)']\n"
                      "grid: {outliers: [0, 0.25]}\nmetrics: [rotation_deg, nees]\n"
                      "tables: [{columns: ['rms(rotation_deg, where=fine)']}]\n"
                      "plots: [{name: growth, x: outliers, y: median(rotation_deg)}]\n");
  return path;
}

std::string RunArguments(const std::filesystem::path& experiment, const std::string& out) {
  return "run " + Quoted(experiment) + " --no-csv --out " + Quoted(TestFolder() / out);
}

std::string Rows(const std::string& out) { return ReadText(TestFolder() / out / "rows.sxtrows"); }

// The rows of one process, for comparison.
std::string WholeRows(const std::filesystem::path& experiment) {
  const ProgramRun run = RunProgram(SEXTANT_BINARY, RunArguments(experiment, "whole"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return Rows("whole");
}

int CountOf(const std::string& part, const std::string& text) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++count;
  }
  return count;
}

class Mpi : public testing::Test {
 protected:
  void SetUp() override {
#ifndef SEXTANT_MPI_BINARY
    GTEST_SKIP() << "sextant-mpi was not built: MPI was not found";
#endif
  }

  // A command of the shell in the place of a rank, whose number is in $OMPI_COMM_WORLD_RANK.
  static ProgramRun Start(int ranks, const std::string& rank_command) {
    const std::string shell = "sh -c " + Quoted(rank_command);
    return RunProgram(std::string(kAsRootOnOneCore) +
                          "OMPI_MCA_btl=self,vader "
                          "OMPI_MCA_btl_vader_single_copy_mechanism=none " +
                          Mpirun(),
                      "-n " + std::to_string(ranks) + " " + shell);
  }

  static ProgramRun Run(int ranks, const std::filesystem::path& experiment,
                        const std::string& out) {
    return Start(ranks, "exec " + Program() + " " + Unquoted(RunArguments(experiment, out)));
  }

  // Kills one of the ranks as soon as it has written two more blocks of its rows, or three.
  static ProgramRun RunKilled(int ranks, int killed, const std::filesystem::path& experiment,
                              const std::string& out) {
    const std::string rows = (TestFolder() / out / "shard_").string() + std::to_string(killed + 1) +
                             "_of_" + std::to_string(ranks) + ".sxtrows";
    const std::string size = "$(stat -c %s " + rows + " 2>/dev/null || echo 0)";
    return Start(ranks, "if [ $OMPI_COMM_WORLD_RANK = " + std::to_string(killed) +
                            " ]; then enough=$((" + size +
                            " + 20000)); (for i in $(seq 3000); do " + "[ " + size +
                            " -gt $enough ] && kill -KILL $$ && break; sleep 0.01; done) " +
                            ">/dev/null 2>&1 & fi; exec " + Program() + " " +
                            Unquoted(RunArguments(experiment, out)));
  }

  // The test's folder has no blank in its name.
  static std::string Unquoted(std::string arguments) {
    std::erase(arguments, '\'');
    return arguments;
  }

#ifdef SEXTANT_MPI_BINARY
  static std::string Program() { return SEXTANT_MPI_BINARY; }
  static std::string Mpirun() { return SEXTANT_MPIRUN; }
#else
  static std::string Program() { return {}; }
  static std::string Mpirun() { return {}; }
#endif
};

TEST_F(Mpi, SameBytesAsOneProcess) {
  const std::filesystem::path experiment = WriteExperiment(450);
  WholeRows(experiment);
  for (const int ranks : {1, 2, 4}) {
    const std::string out = "ranks" + std::to_string(ranks);
    const ProgramRun run = Run(ranks, experiment, out);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("rms(rotation_deg,where=fine)"));
    for (const char* name :
         {"rows.sxtrows", "summary.json", "report.md", "tables.tex", "growth.svg"}) {
      EXPECT_TRUE(ReadText(TestFolder() / out / name) == ReadText(TestFolder() / "whole" / name))
          << name << " of " << ranks << " ranks";
    }
    EXPECT_FALSE(std::filesystem::exists(TestFolder() / out / "shard_1_of_2.sxtrows"));
  }
}

// Long enough that a rank is killed before it is done, however busy the machine is: after 20 kB of
// the 250 kB or more that it writes.
constexpr int kLongRun = 10000;

// Its rows, once per process.
const std::string& RowsOfLongRun() {
  static const std::string rows = WholeRows(WriteExperiment(kLongRun));
  return rows;
}

TEST_F(Mpi, AKilledRankLosesWhatWasInFlight) {
  const std::string& whole = RowsOfLongRun();
  const std::filesystem::path experiment = WriteExperiment(kLongRun);
  for (const int killed : {1, 0}) {
    const std::string out = "killed" + std::to_string(killed);
    EXPECT_NE(RunKilled(2, killed, experiment, out).exit_code, 0)
        << "it was done before it could be killed";
    const std::filesystem::path rows =
        TestFolder() / out / ("shard_" + std::to_string(killed + 1) + "_of_2.sxtrows");
    ASSERT_TRUE(std::filesystem::exists(rows)) << rows;
    EXPECT_GT(std::filesystem::file_size(rows), 20000U) << rows;
    const ProgramRun last = Run(2, experiment, out);
    ASSERT_EQ(last.exit_code, 0) << last.err;
    EXPECT_THAT(last.err, HasSubstr(" of 20000 trials were already in"));
    EXPECT_TRUE(Rows(out) == whole);
  }
  EXPECT_THAT(Run(2, experiment, "killed0").err,
              HasSubstr("20000 of 20000 trials were already in"));
}

TEST_F(Mpi, AnyNumberOfRanksGoesOnWithTheRowsOfAnother) {
  const std::string& whole = RowsOfLongRun();
  const std::filesystem::path experiment = WriteExperiment(kLongRun);
  ASSERT_EQ(RunProgram(SEXTANT_BINARY, RunArguments(experiment, "out") + " --shard 2/5").exit_code,
            0);
  EXPECT_NE(RunKilled(4, 3, experiment, "out").exit_code, 0);
  const ProgramRun last = Run(3, experiment, "out");
  ASSERT_EQ(last.exit_code, 0) << last.err;
  EXPECT_THAT(last.err, HasSubstr("trials were already in"));
  EXPECT_TRUE(Rows("out") == whole);
}

// Somebody else has the file of the second rank.
TEST_F(Mpi, WhatFailsOnOneRankIsToldAndEndsAll) {
  const std::filesystem::path experiment = WriteExperiment(300);
  std::filesystem::create_directories(TestFolder() / "out");
  const std::string rank = "exec " + Program() + " " + Unquoted(RunArguments(experiment, "out"));
  const ProgramRun run = Start(3, "if [ $OMPI_COMM_WORLD_RANK = 1 ]; then exec flock " +
                                      (TestFolder() / "out" / "shard_2_of_3.sxtrows").string() +
                                      " " + rank.substr(5) + "; else " + rank + "; fi");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("sextant run: rank 1 of 3 on "));
  EXPECT_THAT(run.err, MatchesRegex("(.|\n)*: process [0-9]+ writes it; (.|\n)*"));
  const ProgramRun again = Run(3, experiment, "out");
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_TRUE(Rows("out") == WholeRows(experiment));
}

// A limit of the file's size stands for a full disk of one rank's machine.
TEST_F(Mpi, AFullDiskOfOneRankLosesNothing) {
  const std::filesystem::path experiment = WriteExperiment(2000);
  const std::string rank = Program() + " " + Unquoted(RunArguments(experiment, "out"));
  const ProgramRun full =
      Start(2,
            "if [ $OMPI_COMM_WORLD_RANK = 1 ]; then trap \"\" XFSZ; ulimit -f 48; fi; "
            "OMPI_MCA_btl=self,tcp exec " +
                rank);
  EXPECT_EQ(full.exit_code, 4);
  EXPECT_THAT(full.err, HasSubstr("free some space and run the same command again"));
  const ProgramRun again = Run(2, experiment, "out");
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr(" of 4000 trials were already in"));
  EXPECT_TRUE(Rows("out") == WholeRows(experiment));
}

TEST_F(Mpi, AMistakeOfTheUserIsToldOnce) {
  const ProgramRun no_file = Start(2, "exec " + Program() + " run nowhere.yaml");
  EXPECT_EQ(no_file.exit_code, 2);
  EXPECT_EQ(CountOf("cannot read 'nowhere.yaml'", no_file.err), 1) << no_file.err;
  const ProgramRun no_option = Start(2, "exec " + Program() + " run x.yaml --shard 1/2");
  EXPECT_EQ(no_option.exit_code, 2);
  EXPECT_EQ(CountOf("--shard", no_option.err + no_option.out), 1) << no_option.err;
}

TEST_F(Mpi, TheSlurmJobStartsIt) {
  const std::filesystem::path experiment = WriteExperiment(150);
  const std::filesystem::path bin = SourceRoot() / "tests/mpi/bin";
  const ProgramRun run =
      RunProgram(std::string(kAsRootOnOneCore) + "SLURM_CPUS_PER_TASK=1 SEXTANT_MPI=" + Program() +
                     " MPIRUN=" + Mpirun() + " PATH=" + bin.string() + ":$PATH " +
                     (SourceRoot() / "scripts/slurm/mpi").string(),
                 Quoted(experiment) + " --no-csv --out " + Quoted(TestFolder() / "out"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(Rows("out") == WholeRows(experiment));
}

TEST(SlurmArray, ItsShardsMergeToTheWhole) {
  const std::filesystem::path experiment = WriteExperiment(450);
  const std::string script = "SEXTANT=" SEXTANT_BINARY " SLURM_CPUS_PER_TASK=1 " +
                             (SourceRoot() / "scripts/slurm/array").string();
  const std::string arguments =
      "3 " + Quoted(experiment) + " --no-csv --out " + Quoted(TestFolder() / "parts");
  for (const char* task : {"3", "1", "2"}) {
    const ProgramRun run =
        RunProgram("SLURM_ARRAY_TASK_ID=" + std::string(task) + " " + script, arguments);
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  const ProgramRun merge =
      RunProgram(SEXTANT_BINARY,
                 "merge " + Quoted(experiment) + " --no-csv " + (TestFolder() / "parts").string() +
                     "/shard_*_of_3.sxtrows --out " + Quoted(TestFolder() / "parts"));
  ASSERT_EQ(merge.exit_code, 0) << merge.err;
  EXPECT_TRUE(Rows("parts") == WholeRows(experiment));
  EXPECT_EQ(RunProgram(script, arguments).exit_code, 2) << "without a task there is no shard";
}

}  // namespace
}  // namespace sextant::test
