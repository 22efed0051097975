// SPDX-License-Identifier: Apache-2.0
#include <exception>

#include "base/version.h"
#include "cli/mpi/run_on_ranks.h"
#include "cli/output.h"
#include "cli/run_program.h"
#include "io/output/standard_output.h"

namespace sextant::cli {
namespace {

constexpr const char* kFooter =
    "Each rank runs its share of the trials into a row file of its own; the first joins them to "
    "the\n"
    "bytes of sextant run and writes the report. All ranks must share the folder of --out. "
    "Existing\n"
    "rows, of any number of ranks or of --shard, are not run again.\n"
    "Examples:\n"
    "  mpirun -n 4 sextant-mpi run experiments/leaderboard.yaml\n"
    "  mpirun --hostfile machines --map-by ppr:1:node --bind-to none sextant-mpi run x.yaml";

// The other ranks would wait for one that has ended.
int RunOrAbort(const Ranks& ranks, const ExperimentOptions& options) {
  try {
    return RunOnRanks(ranks, options);
  } catch (const std::exception& error) {
    PrintError("sextant-mpi run: rank {}: {}\n", ranks.rank(), error.what());
    ranks.Abort(kFailed);
  }
}

int Main(int argc, char** argv) {
  const Ranks ranks(&argc, &argv);
  ExperimentOptions options;
  const Program program{
      .name = "sextant-mpi",
      .version = std::string(Version()),
      .introduction =
          "Experiments on many machines: each process that mpirun starts runs its share.",
      .footer = {},
      .groups = {{"Commands",
                  {{.name = "run",
                    .summary = "sextant run, distributed over the ranks",
                    .footer = kFooter,
                    .declare = [&](Arguments& arguments) { DeclareRun(options, arguments); },
                    .run = [&] { return RunOrAbort(ranks, options); }}}}}};
  ParsedLine line = ParseLine(program, argc, argv);
  if (!ranks.is_first()) line.out = line.err = {};
  return RunLine(program, line);
}

}  // namespace
}  // namespace sextant::cli

int main(int argc, char** argv) {
  sextant::cli::PrepareProcess();
  return sextant::cli::Main(argc, argv);
}
