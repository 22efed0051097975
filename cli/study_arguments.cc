// SPDX-License-Identifier: Apache-2.0
#include "cli/study_arguments.h"

#include <CLI/CLI.hpp>

namespace sextant::cli {

void AddFuse(CLI::App& app, FuseOptions& options) {
  CLI::App& command =
      *app.add_subcommand("fuse", "Point clouds of calibrated sensors in one frame");
  command
      .add_option("CLOUD", options.clouds,
                  "Clouds, each in the frame of its own camera: PCD, PLY, KITTI .bin or CSV")
      ->required();
  command.add_option("--from", options.from,
                     "cam_from_lidar of the camera of each cloud but the last: result.yaml, JSON\n"
                     "of sextant solve, or a 4x4 matrix in rows");
  command.add_option("--to", options.to, "The same of the last cloud: all go to its frame");
  command.add_option("--rts", options.rts_path,
                     "Instead: rts.txt of the original package, a 4x4 matrix a cloud");
  command.add_option("--out", options.out, "Cloud to write: .ply (a colour a cloud) or .pcd")
      ->capture_default_str();
  command.footer(
      "Cameras need not see the same: the LiDAR joins them. last_from_cloud = T_last * "
      "inverse(T).\n"
      "Examples:\n"
      "  sextant fuse front.pcd side.pcd --from front.yaml --to side.yaml --out both.ply\n"
      "  sextant fuse cam1.pcd cam2.pcd --rts conf/rts.txt");
}

namespace {

CLI::App& AddRunOfAll(CLI::App& app, ExperimentOptions& options) {
  CLI::App& command = *app.add_subcommand(
      "run", "An experiment: solvers, conditions and trials of a file, to tables and plots");
  command.add_option("EXPERIMENT", options.experiment_path, "Experiment file (YAML)")->required();
  command.add_option("--out", options.out,
                     "Folder to write; a run that was stopped goes on where it was.\n"
                     "Default: results/NAME");
  command.add_option(
      "--solvers", options.solvers,
      "Instead of the file's, separated by commas; conditions that they have no data\n"
      "for are left out");
  command
      .add_option("--threads", options.threads,
                  "Default: as many as the machine has; of ranks that share one, its share")
      ->check(CLI::Range(1, 1024));
  command.add_option("--trials", options.trials, "Instead of the file's")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1'000'000'000}));
  command.add_option("--seed", options.seed, "Instead of the file's");
  command.add_flag("--quick", options.quick, "The file's quick_trials instead of its trials");
  command.add_flag("--fresh", options.fresh, "Throw away rows that are there");
  command.add_flag("--no-csv", options.no_csv, "Without rows.csv, which is large for many trials");
  return command;
}

}  // namespace

void AddRun(CLI::App& app, ExperimentOptions& options) {
  CLI::App& command = AddRunOfAll(app, options);
  command.add_option("--shard", options.shard,
                     "I/N: the I-th of N parts only, for as many machines; join them by merge");
  command.footer(
      "Writes rows.sxtrows (all that was measured), rows.csv, summary.json, report.md, tables.tex\n"
      "and the plots. The same file and seed give the same bytes on any number of threads.\n"
      "Examples:\n"
      "  sextant run experiments/leaderboard.yaml --quick\n"
      "  sextant run experiments/leaderboard.yaml --solvers 'kabsch,my_solver' --out mine\n"
      "  sextant run experiments/accuracy.yaml --shard 2/8 --out /tmp/accuracy");
}

void AddRunOnRanks(CLI::App& app, ExperimentOptions& options) {
  AddRunOfAll(app, options)
      .footer(
          "Each rank runs its share of the trials into a row file of its own; the first joins them "
          "to\n"
          "the bytes of sextant run and writes the report. The folder of --out must be one that "
          "all "
          "ranks\n"
          "share. Rows that are there, of any number of ranks or of --shard, are not run again.\n"
          "Examples:\n"
          "  mpirun -n 4 sextant-mpi run experiments/leaderboard.yaml\n"
          "  mpirun --hostfile machines --map-by ppr:1:node --bind-to none sextant-mpi run x.yaml");
}

void AddMerge(CLI::App& app, ExperimentOptions& options) {
  CLI::App& command = *app.add_subcommand("merge", "The shards of an experiment, to one report");
  command.add_option("EXPERIMENT", options.experiment_path, "Experiment file (YAML)")->required();
  command.add_option("ROWS", options.row_files, "The row files of all shards")->required();
  command.add_option("--out", options.out, "Folder to write. Default: results/NAME");
  command.add_option("--trials", options.trials, "As the shards were run with");
  command.add_option("--seed", options.seed, "As the shards were run with");
  command.add_flag("--quick", options.quick, "As the shards were run with");
  command.add_flag("--no-csv", options.no_csv, "Without rows.csv");
  command.footer(
      "The same bytes as one run on one machine.\n"
      "Example:\n  sextant merge experiments/accuracy.yaml results/accuracy/shard_*.sxtrows");
}

void AddKinds(CLI::App& app) {
  app.add_subcommand("kinds", "The kinds of experiments, their parameters and metrics (Markdown)");
}

void AddReproduce(CLI::App& app, ReproduceOptions& options) {
  CLI::App& command = *app.add_subcommand(
      "reproduce", "The paper's experiments again, with known truth, and a verdict on every claim");
  command.add_flag("--quick", options.quick, "Few trials: a minute instead of ten or more");
  command.add_option("--out", options.out,
                     "Folder to write; default: paper, or build/paper-quick with --quick. A run\n"
                     "that was stopped goes on where it was");
  command.add_option("--experiments", options.experiments, "Folder of the experiment files")
      ->capture_default_str();
  command.add_option("--claims", options.claims, "What the paper says, and the rule for each")
      ->capture_default_str();
  command.add_option("--threads", options.threads, "0: as many as the machine has")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command.footer(
      "Run it in the project's folder. Real logs are looked for in SEXTANT_DATA, else in\n"
      "../shared/data; claims that need them are not testable without.\n"
      "Examples:\n"
      "  sextant reproduce --quick\n"
      "  sextant reproduce");
}

}  // namespace sextant::cli
