// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calibrate/calibrate.h"

namespace sextant {

/// "GOOD: reason. What to do next.", in lines of at most 100 characters.
std::string DescribeVerdict(const ResultVerdict& verdict);

/// The same for a result that is NOT USABLE, for commands that use it; else empty.
std::string CautionAbout(const CalibrationResult& result);

/// All that `sextant calibrate` prints, at most 100 characters a line but for tables of solvers:
/// the verdict, the boards of each view, the answer with its error against the truth where known,
/// the other solvers' answers, the warnings, and the summary. Without a result: the status of the
/// boards, and the warnings.
std::string DescribeCalibration(const Calibration& calibration);

}  // namespace sextant
