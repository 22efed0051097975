// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "io/results/calibration_result.h"
#include "report/page/page.h"

namespace sextant {

/// The next placement of a board as `sextant advise` proposes it, with its picture; or why there is
/// none.
PageNext NextOf(const CalibrationResult& result);

}  // namespace sextant
