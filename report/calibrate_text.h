// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "calibrate/calibrate.h"

namespace sextant {

/// All that `sextant calibrate` prints: the boards of each view, the answer with its error against
/// the truth where known, the other solvers' answers, the warnings, and the summary. Without
/// a result: the status of the boards, and the warnings.
std::string DescribeCalibration(const Calibration& calibration);

/// The text in lines of at most `width` characters, broken at blanks.
std::string Wrapped(const std::string& text, std::size_t width);

}  // namespace sextant
