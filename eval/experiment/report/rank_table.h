// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "eval/statistics/text_table.h"

namespace sextant {

/// Ranks of subjects by an error, over all trials. In each trial the smallest error has rank 1,
/// equal ones share the mean of their ranks, and those without one, which failed, share the last.
///
/// The table is sorted by the mean rank, and compares each subject with the first one: the share of
/// trials in which it is better, of those in which the two differ, with its 95 percent interval,
/// and the two-sided p of the sign test, which pairs the two by trial. `errors`: for each name one
/// value per trial, as many for each; NaN: failed.
TextTable RankTable(std::span<const std::string> names,
                    std::span<const std::vector<double>> errors);

}  // namespace sextant
