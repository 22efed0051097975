// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "eval/experiment/run/run_trials.h"

namespace sextant {

/// "shard_2_of_8.sxtrows", as every run names the rows of a part.
std::string PartFileName(const Shard& shard);

/// The row files of a folder: the whole's, rows.sxtrows, and those of parts, of any number of
/// parts. Left out are those of runs that were killed before they had written the configuration.
std::vector<std::filesystem::path> RowFilesIn(const std::filesystem::path& folder,
                                              const std::string& configuration);

/// The blocks that the files hold, ascending, each once. Errors: kIo, kParse; kInvalidInput (rows
/// of another configuration).
Expected<std::vector<std::uint64_t>> BlocksHeldBy(const std::vector<std::filesystem::path>& files,
                                                  const std::string& configuration);

/// Removes all row files of the folder. Errors: kIo.
Expected<void> RemoveRowFiles(const std::filesystem::path& folder);

/// Joins the row files of the folder to the rows.sxtrows that one run writes, byte for byte, and
/// then removes those of parts. Killed at any moment it loses nothing. Errors: those of
/// MergeRowFiles; kIo.
Expected<void> JoinRowFiles(const std::filesystem::path& folder, const std::string& configuration);

}  // namespace sextant
