// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calibrate/trust/trust.h"
#include "io/results/calibration_result.h"

namespace sextant {

/// Compares the solver's covariance, bootstrap and cross-validation in a few sentences. Ratios up
/// to 1 + 2 / sqrt(2 (n - 1)), two standard errors of a standard deviation, count as agreement.
std::string DescribeChecks(const TrustFigures& figures, int views);

/// The warning for an outlying view, with its error.
std::string OutlierText(const std::string& name, const ViewTrust& view,
                        const TrustFigures& figures);

}  // namespace sextant
