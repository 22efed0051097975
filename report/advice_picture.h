// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "calibrate/advise/advise.h"

namespace sextant {

/// Draws the proposals, numbered, and the boards of the existing views: from above on the left, and
/// in the camera's image on the right, with the predicted LiDAR returns on the proposals.
cv::Mat DrawAdvice(const CalibrationResult& result, const SensorPair& sensors,
                   const std::vector<BoardProposal>& proposals);

}  // namespace sextant
