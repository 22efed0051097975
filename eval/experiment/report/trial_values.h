// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "base/error.h"
#include "eval/experiment/report/condition_rows.h"

namespace sextant {

/// One metric of each trial: a list for each cell of the condition, in the order of the trials; NaN
/// where a trial has none. 8 bytes a row. Requires a wanted metric. Error: kIo.
Expected<std::vector<std::vector<double>>> TrialValuesOf(const ConditionRows& rows, int metric);

}  // namespace sextant
