// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "features/camera/tag_detector.h"

namespace sextant {

/// The inner corners of a checkerboard by OpenCV's sector-based detector (Duda and Frese 2018,
/// "Accurate Detection and Localization of Checkerboard Corners for Calibration", BMVC), then each
/// moved to where the gradients in a window around it are orthogonal to the lines to it
/// (cornerSubPix; Foerstner and Guelch 1987): in real photos the detector alone can place a whole
/// board half a pixel elsewhere (docs/detectors.md). Its pixels are ours. One board of a given size
/// an image.
///
/// The first corner is beside a black outer square. Where columns + rows is odd that says which way
/// round the board is; where it is even, of the two ways the one whose first corner is further up
/// in the image is given, and `is_turn_known` is false.
TagDetectorEntry CheckerboardDetectorEntry();

}  // namespace sextant
