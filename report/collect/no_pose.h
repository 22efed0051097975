// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calibrate/calibrate.h"
#include "io/results/calibration_result.h"
#include "report/page/page.h"

namespace sextant {

/// A calibration that found no pose, in the form of a result: sensors, boards, every view as left
/// out with its reason, and the verdict NOT USABLE with the cause. Its pose means nothing.
CalibrationResult ResultWithoutPose(const Calibration& calibration);

/// Removes what was drawn with the pose of the result, and keeps what each sensor saw by itself.
void DropWhatNeedsThePose(ReportPage& page);

}  // namespace sextant
