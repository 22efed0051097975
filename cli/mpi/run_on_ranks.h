// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/experiment_run.h"
#include "cli/mpi/ranks.h"

namespace sextant::cli {

/// `sextant-mpi run`: rank r of n runs the blocks of shard r + 1 of n that no row file in the
/// folder holds, and writes them into a row file of its own. The first rank joins the files to the
/// bytes of `sextant run` and writes the report. A failure on any rank ends all of them; the first
/// rank prints it. Returns the exit code of this rank.
int RunOnRanks(const Ranks& ranks, const ExperimentOptions& options);

}  // namespace sextant::cli
