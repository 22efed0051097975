// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "calibrate/calibrate.h"
#include "eval/metrics/compare.h"
#include "io/results/calibration_result.h"
#include "report/page/page.h"

namespace sextant {

/// 1 sigma of each unknown: of the result, and by each method that checks it.
PageTable SigmaTable(const CalibrationResult& result);

/// None without a covariance.
std::optional<PageCorrelation> CorrelationOf(const CalibrationResult& result);

/// Noise levels, and what was estimated besides the pose with its prior. `calibration` may be null.
PageTable NoiseTable(const CalibrationResult& result, const Calibration* calibration);

/// The calibration's own comparison or, where it has a single solver, one with a few others on the
/// same data, which takes about a second. `calibration` may be null.
PageTable ComparisonTable(const Calibration* calibration);

}  // namespace sextant
