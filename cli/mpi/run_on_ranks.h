// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/commands.h"
#include "cli/mpi/ranks.h"

namespace sextant::cli {

/// `sextant-mpi run`: rank r of n runs the blocks of shard r + 1 of n that no row file in the
/// folder holds, whoever wrote it, into a row file of its own; the first rank joins them to the
/// bytes of `sextant run` and writes the report. What fails on any rank is told by the first, and
/// all end. Returns the exit code of this rank.
int RunOnRanks(const Ranks& ranks, const ExperimentOptions& options);

}  // namespace sextant::cli
