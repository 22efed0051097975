// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>

#include "base/version.h"
#include "cli/mpi/run_on_ranks.h"
#include "cli/study_arguments.h"

namespace sextant::cli {
namespace {

int Main(int argc, char** argv) {
  const Ranks ranks(&argc, &argv);
  CLI::App app("Experiments on many machines: each process that mpirun starts runs its share.",
               "sextant-mpi");
  app.set_version_flag("--version", std::string(Version()));
  app.require_subcommand(1);
  ExperimentOptions options;
  AddRunOnRanks(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (ranks.is_first()) app.exit(error);
    return error.get_exit_code() == 0 ? kAnswered : kWrongUse;
  }
  return RunOnRanks(ranks, options);
}

}  // namespace
}  // namespace sextant::cli

int main(int argc, char** argv) { return sextant::cli::Main(argc, argv); }
