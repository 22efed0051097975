// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include "cli/commands/commands.h"
#include "cli/experiment_run.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "eval/experiment/run/part_files.h"
#include "io/output/output_folder.h"

namespace sextant::cli {
namespace {

struct MergeOptions {
  ExperimentOptions experiment{};
  std::vector<std::string> row_files{};
};

void Declare(MergeOptions& options, Arguments& arguments) {
  DeclareExperiment(options.experiment, arguments);
  arguments.Add("ROWS", options.row_files, "The row files of all shards", {.required = true});
}

int Run(const MergeOptions& options) {
  const Expected<Experiment> experiment = LoadExperiment(options.experiment);
  if (!experiment) return Refuse("merge", experiment.error());
  const std::filesystem::path folder = FolderOf(options.experiment, *experiment);
  const Expected<OutputFolder> locked = OutputFolder::Open(folder);
  if (!locked) return Refuse("merge", locked.error());
  const std::vector<std::filesystem::path> shards(options.row_files.begin(),
                                                  options.row_files.end());
  Expected<void> ok = ClaimReport(options.experiment, *experiment, folder);
  if (!ok) return Refuse("merge", ok.error());
  Progress progress;
  ProgressCounter steps(progress.Callback(), "merging", 2);
  ok = MergeRowFiles(shards, folder / "rows.sxtrows", ConfigurationOf(*experiment));
  if (!ok) return Refuse("merge", ok.error());
  steps.Step();
  return WriteTables("merge", options.experiment, *experiment, folder);
}

}  // namespace

Command MergeCommand() {
  constexpr const char* kFooter =
      "Gives the same bytes as one run on one machine. Takes the options that change the "
      "experiment\n"
      "as the shards were run with them. Nothing is replaced before all rows are checked, and the\n"
      "rows of another experiment only with --overwrite.\n"
      "Example:\n  sextant merge experiments/accuracy.yaml results/accuracy/shard_*.sxtrows";
  return MakeCommand<MergeOptions>("merge", "The shards of an experiment, to one report", kFooter,
                                   Declare, Run);
}

}  // namespace sextant::cli
