// SPDX-License-Identifier: Apache-2.0
// bench_compare <old folder> <new folder>: the comparison printed by scripts/bench-compare. Returns
// 1 if something has become significantly slower, or wrong.
#include <fmt/core.h>

#include <cstdio>

#include "bench/compare.h"

int main(int argc, char** argv) {
  namespace bench = sextant::bench;
  if (argc != 3) {
    std::fputs("usage: bench_compare <folder of old results> <folder of new results>\n", stderr);
    return 2;
  }
  const sextant::Expected<bench::Timings> before = bench::ReadTimings(argv[1]);
  const sextant::Expected<bench::Timings> after = bench::ReadTimings(argv[2]);
  for (const auto* timings : {&before, &after}) {
    if (*timings) continue;
    fmt::print(stderr, "bench_compare: {}\n", timings->error().message);
    return 2;
  }
  const std::vector<bench::Difference> differences = bench::CompareTimings(*before, *after);
  fmt::print("{}", bench::FormatDifferences(differences));
  return bench::HasRegression(differences) ? 1 : 0;
}
