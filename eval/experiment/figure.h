// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eval/experiment/condition_rows.h"
#include "eval/experiment/statistic.h"
#include "eval/statistics.h"

namespace sextant {

/// A statistic's value over the trials of one cell.
struct Figure {
  double value = std::numeric_limits<double>::quiet_NaN();  ///< NaN where no trial counts.
  std::optional<Interval> interval;  ///< 95 percent: bootstrap, for rates Wilson's.
  std::uint64_t trials = 0;          ///< That count.
};

/// Of the values of one cell; `reference` and `where` are empty where the statistic has none. NaN
/// values do not count, but for rates, where they count as 0. The seed is the bootstrap's.
Figure ComputeFigure(const Statistic& statistic, std::vector<double> values,
                     std::span<const double> reference, std::span<const double> where,
                     std::uint64_t seed);

/// The statistic of every cell of the condition, in the order of its cells.
Expected<std::vector<Figure>> ComputeFigures(const Statistic& statistic, const ConditionRows& rows,
                                             std::uint64_t seed);

}  // namespace sextant
