// SPDX-License-Identifier: Apache-2.0
#include "bench/results.h"

#include <fmt/core.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

namespace sextant::bench {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

double Nanoseconds(const json& benchmark) {
  static const std::map<std::string, double> kUnits = {
      {"ns", 1.0}, {"us", 1e3}, {"ms", 1e6}, {"s", 1e9}};
  return benchmark.at("cpu_time").get<double>() *
         kUnits.at(benchmark.at("time_unit").get<std::string>());
}

}  // namespace

void AddTimings(const json& run, Timings& timings) {
  Timings of_run;
  for (const json& benchmark : run.at("benchmarks")) {
    Timing& timing = of_run[benchmark.at("run_name").get<std::string>()];
    if (benchmark.value("error_occurred", false)) {
      timing.error = benchmark.value("error_message", "failed");
      continue;
    }
    const std::string aggregate = benchmark.value("aggregate_name", "");
    if (aggregate == "median") timing.median_ns = Nanoseconds(benchmark);
    if (aggregate == "cv") timing.spread = benchmark.at("cpu_time").get<double>();
  }
  for (auto& [name, timing] : of_run) {
    const auto [before, is_new] = timings.try_emplace(name, timing);
    if (is_new || !before->second.median_ns) continue;
    if (!timing.median_ns || *timing.median_ns < *before->second.median_ns) {
      before->second = timing;
    }
  }
}

Expected<Timings> ReadTimings(const fs::path& folder) {
  Timings timings;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() != ".json") continue;
    std::ifstream file(entry.path());
    const json run = json::parse(file, nullptr, /*allow_exceptions=*/false);
    if (!run.is_object() || !run.contains("benchmarks")) {
      return MakeError(ErrorCode::kParse,
                       fmt::format("{}: expected the JSON of Google Benchmark; run scripts/bench "
                                   "again",
                                   entry.path().string()));
    }
    AddTimings(run, timings);
  }
  if (!timings.empty()) return timings;
  return MakeError(
      ErrorCode::kIo,
      fmt::format("'{}' has no results: expected a folder of JSON files as scripts/bench "
                  "leaves in build/release/bench/results",
                  folder.string()));
}

std::string FormatTime(double ns) {
  if (ns < 1e3) return fmt::format("{:.0f} ns", ns);
  if (ns < 1e6) return fmt::format("{:.2f} us", ns * 1e-3);
  return fmt::format("{:.2f} ms", ns * 1e-6);
}

}  // namespace sextant::bench
