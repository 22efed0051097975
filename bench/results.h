// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "base/error.h"

namespace sextant::bench {

struct Timing {
  std::optional<double> median_ns;  ///< None if the result was wrong.
  double spread = 0.0;  ///< Standard deviation of the repetitions divided by their mean.
  std::string error;
};

/// Timings by name, task/implementation/N; ours is `sextant`, the others are peers.
using Timings = std::map<std::string, Timing>;

/// Adds the benchmarks of one run of Google Benchmark. Of several runs of a benchmark, the fastest
/// is kept, or the one that was wrong.
void AddTimings(const nlohmann::json& run, Timings& timings);

/// Reads all *.json files of a folder written by scripts/bench. Errors: kIo (no such folder, or no
/// files in it); kParse.
Expected<Timings> ReadTimings(const std::filesystem::path& folder);

/// Formats a time, such as "12.3 us".
std::string FormatTime(double ns);

}  // namespace sextant::bench
