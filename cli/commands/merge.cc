// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include "cli/commands/commands.h"
#include "cli/experiment_run.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "eval/experiment/run/part_files.h"

namespace sextant::cli {
namespace {

struct MergeOptions {
  ExperimentOptions experiment{};
  std::vector<std::string> row_files{};
};

void Declare(MergeOptions& options, Arguments& arguments) {
  ExperimentOptions& experiment = options.experiment;
  arguments.Add("EXPERIMENT", experiment.experiment_path, "Experiment file (YAML)",
                {.required = true});
  arguments.Add("ROWS", options.row_files, "The row files of all shards", {.required = true});
  arguments.Add("--out", experiment.out, "Folder to write. Default: results/NAME");
  arguments.Add("--trials", experiment.trials, "The value with which the shards were run");
  arguments.Add("--seed", experiment.seed, "The value with which the shards were run");
  arguments.Add("--quick", experiment.quick, "If the shards were run with it");
  arguments.Add("--no-csv", experiment.no_csv, "Without rows.csv");
}

int Run(const MergeOptions& options) {
  const Expected<Experiment> experiment = LoadExperiment(options.experiment);
  if (!experiment) return Refuse("merge", experiment.error());
  const std::filesystem::path folder = FolderOf(options.experiment, *experiment);
  if (Expected<void> ok = MakeFolder(folder); !ok) return Refuse("merge", ok.error());
  const std::vector<std::filesystem::path> shards(options.row_files.begin(),
                                                  options.row_files.end());
  Progress progress;
  ProgressCounter steps(progress.Callback(), "merging", 2);
  if (Expected<void> ok = MergeRowFiles(shards, folder / "rows.sxtrows"); !ok) {
    return Refuse("merge", ok.error());
  }
  steps.Step();
  return WriteTables("merge", options.experiment, *experiment, folder);
}

}  // namespace

Command MergeCommand() {
  constexpr const char* kFooter =
      "Gives the same bytes as one run on one machine.\n"
      "Example:\n  sextant merge experiments/accuracy.yaml results/accuracy/shard_*.sxtrows";
  return MakeCommand<MergeOptions>("merge", "The shards of an experiment, to one report", kFooter,
                                   Declare, Run);
}

}  // namespace sextant::cli
