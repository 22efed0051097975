// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calibrate/trust/trust.h"
#include "io/results/calibration_result.h"

namespace sextant {

/// How covariance, bootstrap and cross-validation compare, in sentences, with what follows from it.
/// A ratio is taken for agreement within what so few views can tell: 1 + 2 / sqrt(2 (n - 1)), two
/// standard errors of a standard deviation.
std::string TrustVerdict(const TrustFigures& figures, int views);

/// That the view of that name does not belong to the others, with by how much.
std::string OutlierText(const std::string& name, const ViewTrust& view,
                        const TrustFigures& figures);

}  // namespace sextant
