// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "io/results/calibration_result.h"

namespace sextant::test {

/// A result with every optional part, and one dropped view.
CalibrationResult FullCalibrationResult();

}  // namespace sextant::test
