// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "features/camera/tag_detector.h"

namespace sextant {

/// The inner corners of a checkerboard by OpenCV's sector-based detector (Duda and Frese 2018,
/// "Accurate Detection and Localization of Checkerboard Corners for Calibration", BMVC). Its pixels
/// are ours. One board of a given size an image.
///
/// The first corner is beside a black outer square. Where columns + rows is odd that says which way
/// round the board is; where it is even, of the two ways the one whose first corner is further up
/// in the image is given, and `is_turn_known` is false.
TagDetectorEntry CheckerboardDetectorEntry();

}  // namespace sextant
