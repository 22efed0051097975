// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "bench/results.h"

namespace sextant::bench {

enum class Change {
  kSlower,    ///< Slower than explained by noise: a regression.
  kNowWrong,  ///< Was timed before, and its result is wrong now: a regression.
  kGone,      ///< Was timed before, and is missing now.
  kFaster,    ///< Faster than explained by noise.
  kNew,       ///< Only timed now.
  kSame,      ///< No significant difference, or not timed in either run.
};

struct Difference {
  std::string name;
  Change change = Change::kSame;
  double old_ns = 0.0;
  double new_ns = 0.0;
  double noise = 0.0;  ///< Relative difference of the medians that noise explains.
};

/// Sorted by kind of change, regressions first, then by size. A time has changed if the medians
/// differ by more than three combined standard deviations of a single repetition and by more than 3
/// percent, the effect of code alignment alone.
std::vector<Difference> CompareTimings(const Timings& old_timings, const Timings& new_timings);

/// Whether one of the changes is a regression.
bool HasRegression(const std::vector<Difference>& differences);

/// A table of all changes, and the number of unchanged benchmarks.
std::string FormatDifferences(const std::vector<Difference>& differences);

}  // namespace sextant::bench
