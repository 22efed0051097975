// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/commands.h"

namespace CLI {
class App;
}

namespace sextant::cli {

/// Subcommands of experiments, and that merge what was calibrated.
void AddRun(CLI::App& app, ExperimentOptions& options);
/// Of sextant-mpi: there is no --shard.
void AddRunOnRanks(CLI::App& app, ExperimentOptions& options);
void AddMerge(CLI::App& app, ExperimentOptions& options);
void AddKinds(CLI::App& app);
void AddFuse(CLI::App& app, FuseOptions& options);
void AddReproduce(CLI::App& app, ReproduceOptions& options);

}  // namespace sextant::cli
