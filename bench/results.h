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
  std::optional<double> median_ns;  ///< None where the answer was wrong.
  double spread = 0.0;              ///< Standard deviation over mean of the repetitions.
  std::string error;
};

/// By name, task/implementation/N; ours is `sextant`, the others are peers.
using Timings = std::map<std::string, Timing>;

/// Adds the benchmarks of one run of Google Benchmark. Of several runs of a benchmark the fastest
/// stands, or the one that was wrong.
void AddTimings(const nlohmann::json& run, Timings& timings);

/// All *.json of a folder that scripts/bench has filled. Errors: kIo (no such folder, or none in
/// it); kParse.
Expected<Timings> ReadTimings(const std::filesystem::path& folder);

/// "12.3 us".
std::string FormatTime(double ns);

}  // namespace sextant::bench
