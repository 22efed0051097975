// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "io/results/calibration_result.h"
#include "report/page/page.h"

namespace sextant {

/// Which of the image's cells boards have touched; none without the camera's image size.
std::vector<PageCoverage> CoverageOf(const CalibrationResult& result);

/// Ranges and angles of the kept boards.
std::vector<PagePlot> CoveragePlots(const CalibrationResult& result);

/// Residuals of the corners against the board's range, its angle to the line of sight, and the
/// distance of the corner from the principal point. The views that disagree with the others are a
/// series of their own.
std::vector<PagePlot> ResidualPlots(const CalibrationResult& result);

/// Predicted sigma after each view, for each axis.
std::vector<PagePlot> SigmaPlots(const CalibrationResult& result);

}  // namespace sextant
