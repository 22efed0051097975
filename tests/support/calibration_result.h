// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "io/results/calibration_result.h"

namespace sextant::test {

/// A result in which every optional part is there, and one view was dropped.
CalibrationResult FullCalibrationResult();

}  // namespace sextant::test
