// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "eval/experiment/run/run_trials.h"

namespace sextant {

/// File name of a part's rows, such as "shard_2_of_8.sxtrows".
std::string PartFileName(const Shard& shard);

/// The row files of a folder: rows.sxtrows, which holds the whole experiment, and those of parts,
/// whatever the number of parts. Files of runs that were killed before they had written the
/// configuration are left out.
std::vector<std::filesystem::path> RowFilesIn(const std::filesystem::path& folder,
                                              const std::string& configuration);

/// Whether the file contains only the beginning of the configuration, from a run that was killed.
bool HoldsNothing(const std::filesystem::path& path, const std::string& configuration);

/// The distinct blocks in the files, ascending. Errors: kIo, kParse; kInvalidInput (rows of another
/// configuration).
Expected<std::vector<std::uint64_t>> BlocksHeldBy(const std::vector<std::filesystem::path>& files,
                                                  const std::string& configuration);

/// Removes all row files of the folder. Errors: kUnwritable.
Expected<void> RemoveRowFiles(const std::filesystem::path& folder);

/// Joins the row files of the folder into rows.sxtrows, byte for byte as a single run writes it,
/// and then removes the files of parts. No rows are lost if it is killed at any time. Errors: those
/// of MergeRowFiles and RemoveFile.
Expected<void> JoinRowFiles(const std::filesystem::path& folder, const std::string& configuration);

}  // namespace sextant
