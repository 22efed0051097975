// SPDX-License-Identifier: Apache-2.0
// bench_report <folder of JSON files>: writes the text of docs/performance.md to standard output.
// Names of benchmarks are task/implementation/N; ours is `sextant`, the others are peers.
#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/machine.h"
#include "bench/results.h"

namespace sextant::bench {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

struct Key {
  std::string task;
  long count = 0;
  friend auto operator<=>(const Key&, const Key&) = default;  // NOLINT(modernize-use-nullptr)
};

using Row = std::map<std::string, Timing>;  // Timings by implementation.

// Goal: a kernel is this many times faster than a peer, which is an implementation of the same
// task, or task/implementation.
struct Goal {
  const char* task;
  long count;
  const char* peer;
  double ratio;
};

// Goal: the maximum time of a task.
struct Limit {
  const char* task;
  long count;
  const char* implementation;
  double most_us;
};

constexpr Goal kGoals[] = {
    {"kabsch", 8, "umeyama_fixed", 6.0},
    {"kabsch", 8, "umeyama_dynamic", 12.0},
    {"kabsch", 100, "umeyama_fixed", 6.0},
    {"kabsch", 1000000, "umeyama_dynamic", 5.0},
    {"kabsch", 1000000, "read_points/sextant", 0.9},
    {"p3p", 3, "opengv_kneip", 1.8},
    {"p3p", 3, "opencv_p3p", 25.0},
    {"ippe", 8, "opencv_ippe", 10.0},
    {"ippe", 20, "opencv_ippe", 10.0},
    {"ippe", 100, "opencv_ippe", 10.0},
    {"epnp", 8, "opencv", 5.0},
    {"epnp", 8, "opengv", 5.0},
    {"epnp", 20, "opencv", 5.0},
    {"epnp", 20, "opengv", 5.0},
    {"epnp", 100, "opencv", 5.0},
    {"epnp", 100, "opengv", 5.0},
    {"sqpnp", 8, "opencv", 1.5},
    {"sqpnp", 20, "opencv", 1.5},
    {"sqpnp", 100, "opencv", 1.5},
    {"sqpnp", 1000, "opencv", 1.5},
    {"refine", 20, "opencv_iterative", 25.0},
    {"refine", 20, "opencv_iterative_from_start", 25.0},
    {"refine", 20, "ceres_tiny", 1.5},
    {"ransac_50", 100, "opencv_usac_default", 4.0},
    {"ransac_50", 100, "opencv_usac_fast", 4.0},
    {"corners", 8, "open3d_icp", 2.0},
};

constexpr Limit kLimits[] = {
    {"refine_p3p", 8, "sextant", 4.0},
    {"refine_p3p", 20, "sextant", 4.0},
    {"refine_p3p", 100, "sextant", 5.0},
    {"refine_p3p", 1000, "sextant", 20.0},
    {"refine_p3p_solve", 8, "sextant", 4.0},
    {"refine_p3p_solve", 20, "sextant", 4.0},
    {"refine_p3p_solve", 100, "sextant", 5.0},
    {"refine_p3p_solve", 1000, "sextant", 20.0},
    {"ransac_0", 100, "sextant", 50.0},
    {"ransac_50", 100, "sextant", 50.0},
    {"ransac_80", 100, "sextant", 500.0},
    {"pairs_20", 100, "sextant", 75.0},
    {"pairs_50", 100, "sextant", 75.0},
    {"pairs_80", 100, "sextant", 75.0},
    {"pairs_95", 100, "sextant", 75.0},
    {"pairs_50", 1000, "sextant", 100.0},
    {"pairs_80", 1000, "sextant", 2000.0},
    {"pairs_95", 1000, "sextant", 2000.0},
    {"rooms", 16, "sextant", 5000.0},
    {"rooms", 16, "sextant_biased_rings", 5000.0},
    {"rooms", 64, "sextant", 10000.0},
    {"tags_1280x720", 4, "sextant_aruco", 8000.0},
    {"tags_1280x720", 4, "sextant_apriltag", 8000.0},
    {"boards_in_scan", 2, "vlp16", 10000.0},
    {"calibrate", 1, "one_pair", 40000.0},
};

struct Parsed {
  Key key;
  std::string implementation;
};

// Splits task/implementation/N; the implementation must not contain a slash.
std::optional<Parsed> ParseName(const std::string& name) {
  const std::size_t first = name.find('/');
  const std::size_t last = name.rfind('/');
  if (first == std::string::npos || first == last) return std::nullopt;
  return Parsed{{name.substr(0, first), std::atol(name.c_str() + last + 1)},
                name.substr(first + 1, last - first - 1)};
}

// Benchmarks with other names are left out.
std::map<Key, Row> RowsOf(const Timings& timings) {
  std::map<Key, Row> rows;
  for (const auto& [name, timing] : timings) {
    const std::optional<Parsed> parsed = ParseName(name);
    if (parsed) rows[parsed->key][parsed->implementation] = timing;
  }
  return rows;
}

// The fastest peer; none if there is no peer.
std::optional<double> BestPeer(const Row& row) {
  std::optional<double> best;
  for (const auto& [name, timing] : row) {
    if (name.starts_with("sextant") || !timing.median_ns) continue;
    best = std::min(best.value_or(*timing.median_ns), *timing.median_ns);
  }
  return best;
}

void PrintRow(const Key& key, const Row& row) {
  const bool compared = row.contains("sextant");
  const std::optional<double> best = compared ? BestPeer(row) : std::nullopt;
  for (const auto& [name, timing] : row) {
    if (!timing.median_ns) {
      fmt::print("| {} | {} | {} | not timed: {} | | |\n", key.task, key.count, name, timing.error);
      continue;
    }
    const std::string ratio = best && name == "sextant"
                                  ? fmt::format("{:.1f}x", *best / *timing.median_ns)
                                  : std::string();
    fmt::print("| {} | {} | {} | {} | {:.1f} % | {} |\n", key.task, key.count, name,
               FormatTime(*timing.median_ns), 100.0 * timing.spread, ratio);
  }
}

// None if it was not measured or its result was wrong.
std::optional<double> MedianOf(const std::map<Key, Row>& rows, const Key& key,
                               const std::string& implementation) {
  const auto row = rows.find(key);
  if (row == rows.end()) return std::nullopt;
  const auto timing = row->second.find(implementation);
  if (timing == row->second.end()) return std::nullopt;
  return timing->second.median_ns;
}

void PrintGoals(const std::map<Key, Row>& rows) {
  fmt::print(
      "\n## Goals\n\n| task | N | against | goal | measured | |\n|---|--:|---|--:|--:|---|\n");
  for (const Goal& goal : kGoals) {
    const std::string peer = goal.peer;
    const std::size_t slash = peer.find('/');
    const bool same_task = slash == std::string::npos;
    const auto theirs = MedianOf(rows, {same_task ? goal.task : peer.substr(0, slash), goal.count},
                                 same_task ? peer : peer.substr(slash + 1));
    const auto ours = MedianOf(rows, {goal.task, goal.count}, "sextant");
    if (!ours || !theirs) continue;
    const double ratio = *theirs / *ours;
    fmt::print("| {} | {} | {} | {:.1f}x | {:.1f}x | {} |\n", goal.task, goal.count, goal.peer,
               goal.ratio, ratio, ratio >= goal.ratio ? "reached" : "not reached");
  }
  fmt::print("\n| task | N | by | at most | measured | |\n|---|--:|---|--:|--:|---|\n");
  for (const Limit& limit : kLimits) {
    const auto median = MedianOf(rows, {limit.task, limit.count}, limit.implementation);
    if (!median) continue;
    fmt::print("| {} | {} | {} | {} | {} | {} |\n", limit.task, limit.count, limit.implementation,
               FormatTime(1e3 * limit.most_us), FormatTime(*median),
               *median <= 1e3 * limit.most_us ? "reached" : "not reached");
  }
}

std::string ReadLine(const fs::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

// The machine as described in one of the files; all have the same. The folder was already read
// successfully.
json ContextOf(const fs::path& folder) {
  fs::path run;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".json") run = entry.path();
  }
  std::ifstream file(run);
  return json::parse(file).at("context");
}

void PrintMachine(const fs::path& folder) {
  const json context = ContextOf(folder);
  fmt::print("- machine: {}, {} cores; load at the start {:.1f}\n", ProcessorName(),
             context.at("num_cpus").get<int>(), context.at("load_avg").at(0).get<double>());
  fmt::print("- compiler and flags: {}\n", ReadLine(folder / "flags.txt"));
  const std::string absent = ReadLine(folder / "absent_peers.txt");
  if (!absent.empty()) fmt::print("- peers not installed: {}\n", absent);
  for (const json& cache : context.at("caches")) {
    if (cache.at("type") == "Instruction") continue;
    fmt::print("- L{} cache: {} KiB\n", cache.at("level").get<int>(),
               cache.at("size").get<long>() / 1024);
  }
}

int Main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: bench_report <folder of the JSON files>\n", stderr);
    return 2;
  }
  const fs::path folder = argv[1];
  const Expected<Timings> timings = ReadTimings(folder);
  if (!timings) {
    fmt::print(stderr, "{}\n", timings.error().message);
    return 1;
  }
  const std::map<Key, Row> rows = RowsOf(*timings);
  fmt::print(
      "# Performance\n\nWritten by `scripts/bench`; do not edit. One thread, CPU time, medians of "
      "repetitions; the spread is their standard deviation divided by their mean. Every result was "
      "checked against the truth before timing. Ratios are relative to the fastest peer of the "
      "same run. Profiles and the effect of each change: "
      "[performance_notes.md](performance_notes.md).\n\n");
  PrintMachine(folder);
  PrintGoals(rows);
  fmt::print(
      "\n## Medians\n\n| task | N | implementation | median | spread | faster than the best peer "
      "|\n|---|--:|---|--:|--:|--:|\n");
  for (const auto& [key, row] : rows) PrintRow(key, row);
  return 0;
}

}  // namespace
}  // namespace sextant::bench

int main(int argc, char** argv) { return sextant::bench::Main(argc, argv); }
