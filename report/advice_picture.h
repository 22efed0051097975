// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "calibrate/advise/advise.h"

namespace sextant::cli {

/// The proposals, numbered, and the boards of the views there are: from above on the left, in the
/// camera's image on the right with the LiDAR's returns that are foreseen on them.
cv::Mat DrawAdvice(const CalibrationResult& result, const SensorPair& sensors,
                   const std::vector<BoardProposal>& proposals);

}  // namespace sextant::cli
