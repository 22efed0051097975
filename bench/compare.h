// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "bench/results.h"

namespace sextant::bench {

enum class Change {
  kSlower,    ///< Beyond the noise: a regression.
  kNowWrong,  ///< Was timed, and now its answer is wrong: a regression.
  kGone,      ///< Was timed, and is not there any more.
  kFaster,    ///< Beyond the noise.
  kNew,       ///< Timed now only.
  kSame,      ///< Within the noise, or not timed in either.
};

struct Difference {
  std::string name;
  Change change = Change::kSame;
  double old_ns = 0.0;
  double new_ns = 0.0;
  double noise = 0.0;  ///< Share by which the medians may differ by chance.
};

/// By change, regressions first, then by how much. A time has changed where both medians differ by
/// more than three standard deviations of a single repetition of either run together, and by 3
/// percent: what alignment of code alone does.
std::vector<Difference> CompareTimings(const Timings& old_timings, const Timings& new_timings);

/// Whether one of them is a regression.
bool HasRegression(const std::vector<Difference>& differences);

/// A table of what changed, and how many did not.
std::string FormatDifferences(const std::vector<Difference>& differences);

}  // namespace sextant::bench
