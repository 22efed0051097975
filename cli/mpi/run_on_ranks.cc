// SPDX-License-Identifier: Apache-2.0
#include "cli/mpi/run_on_ranks.h"

#include <fmt/core.h>
#include <tbb/info.h>

#include <algorithm>
#include <optional>
#include <system_error>
#include <thread>

#include "cli/experiment_run.h"
#include "cli/output.h"
#include "eval/experiment/run/part_files.h"
#include "io/output/output_folder.h"
#include "io/output/standard_output.h"

namespace sextant::cli {
namespace {

constexpr const char* kCommand = "run";

// What all ranks share before the first trial.
struct Plan {
  Experiment experiment;
  std::filesystem::path folder;
  std::string configuration;
  std::vector<std::uint64_t> held;     // Blocks that are in some row file of the folder.
  std::optional<OutputFolder> locked;  // By the first rank, for all.
};

template <class T>
Expected<void> WithoutValue(const Expected<T>& value) {
  if (!value) return tl::unexpected<Error>(value.error());
  return {};
}

Expected<void> LockFolder(const ExperimentOptions& options, Plan& plan) {
  SEXTANT_ASSIGN_OR_RETURN(OutputFolder locked, OutputFolder::Open(plan.folder));
  plan.locked.emplace(std::move(locked));
  return ClaimReport(options, plan.experiment, plan.folder);
}

Expected<void> CheckSeen(const std::filesystem::path& folder) {
  std::error_code error;
  if (std::filesystem::is_directory(folder, error)) return {};
  return MakeError(
      ErrorCode::kIo,
      fmt::format("'{}', which the first rank made, is not visible here; name one with --out "
                  "on a file system that all ranks share",
                  folder.string()));
}

Expected<std::vector<std::uint64_t>> FindHeld(const Plan& plan, bool fresh) {
  if (fresh) {
    SEXTANT_RETURN_IF_ERROR(RemoveRowFiles(plan.folder));
  }
  return BlocksHeldBy(RowFilesIn(plan.folder, plan.configuration), plan.configuration);
}

Expected<Plan> MakePlan(const Ranks& ranks, const ExperimentOptions& options) {
  Expected<Experiment> experiment = LoadExperiment(options);
  Expected<void> ok = ranks.Agree(WithoutValue(experiment));
  if (!ok) return tl::unexpected<Error>(std::move(ok.error()));
  Plan plan{.experiment = std::move(*experiment),
            .folder = {},
            .configuration = {},
            .held = {},
            .locked = {}};
  plan.folder = FolderOf(options, plan.experiment);
  plan.configuration = ConfigurationOf(plan.experiment);
  ok = ranks.Agree(ranks.is_first() ? LockFolder(options, plan) : Expected<void>());
  if (ok) ok = ranks.Agree(CheckSeen(plan.folder));
  if (!ok) return tl::unexpected<Error>(std::move(ok.error()));
  Expected<std::vector<std::uint64_t>> held = std::vector<std::uint64_t>();
  if (ranks.is_first()) held = FindHeld(plan, options.fresh);
  ok = ranks.Agree(WithoutValue(held));
  if (!ok) return tl::unexpected<Error>(std::move(ok.error()));
  plan.held = ranks.FromFirst(std::move(*held));
  return plan;
}

// The rank's share of the machine; fewer if mpirun has bound the rank to fewer cores.
int ThreadsOf(const Ranks& ranks, const ExperimentOptions& options) {
  if (options.threads > 0) return options.threads;
  const int share = static_cast<int>(std::thread::hardware_concurrency()) / ranks.on_this_machine();
  return std::max(1, std::min(share, tbb::info::default_concurrency()));
}

void PrintPlan(const Plan& plan, const Ranks& ranks, int threads) {
  std::uint64_t held = 0;
  for (const std::uint64_t block : plan.held) held += TrialsOfBlock(plan.experiment, block);
  PrintError("sextant-mpi run: {} rank{}, {} thread{} on the first", ranks.count(),
             ranks.count() == 1 ? "" : "s", threads, threads == 1 ? "" : "s");
  if (held > 0) {
    PrintError("; {} of {} trials were already in {}{}", held,
               plan.experiment.trials * plan.experiment.conditions.size(), plan.folder.string(),
               plan.held.size() == BlocksOf(plan.experiment) ? ", --fresh runs them again" : "");
  }
  PrintErrorText("\n");
}

Expected<void> RunShare(const Plan& plan, const Ranks& ranks, int threads) {
  if (plan.held.size() == BlocksOf(plan.experiment)) return {};
  const Shard shard{.number = static_cast<std::uint64_t>(ranks.rank()),
                    .of = static_cast<std::uint64_t>(ranks.count())};
  const RunSettings settings{.rows_path = plan.folder / PartFileName(shard),
                             .threads = threads,
                             .shard = shard,
                             .held = plan.held};
  return WithoutValue(ranks.is_first() ? RunWithProgress(plan.experiment, settings)
                                       : RunTrials(plan.experiment, settings));
}

int Finish(const Plan& plan, const ExperimentOptions& options) {
  if (Expected<void> ok = JoinRowFiles(plan.folder, plan.configuration); !ok) {
    return Refuse(kCommand, ok.error());
  }
  return WriteAll(kCommand, options, plan.experiment, plan.folder);
}

int End(const Ranks& ranks, const Error& error) {
  return ranks.is_first() ? Refuse(kCommand, error) : ExitCodeOf(error);
}

}  // namespace

int RunOnRanks(const Ranks& ranks, const ExperimentOptions& options) {
  const Expected<Plan> plan = MakePlan(ranks, options);
  if (!plan) return End(ranks, plan.error());
  const int threads = ThreadsOf(ranks, options);
  if (ranks.is_first()) PrintPlan(*plan, ranks, threads);
  const Expected<void> ok = ranks.Agree(RunShare(*plan, ranks, threads));
  if (!ok) return End(ranks, ok.error());
  return ranks.is_first() ? Finish(*plan, options) : kAnswered;
}

}  // namespace sextant::cli
