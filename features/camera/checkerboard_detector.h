// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "features/camera/tag_detector.h"

namespace sextant {

/// Detects the inner corners of a checkerboard by OpenCV's sector-based detector (Duda and Frese
/// 2018, "Accurate Detection and Localization of Checkerboard Corners for Calibration", BMVC). Each
/// corner is then moved to the point at which the gradients in a window around it are orthogonal to
/// the lines to it (cornerSubPix; Foerstner and Guelch 1987): in real photos the detector alone can
/// displace a whole board by half a pixel (docs/detectors.md). Its pixel origin is ours. At most
/// one board of a given size is found per image. Large images are searched at half their size
/// first; a board that is not found in the whole image, as among much detail, is searched for in
/// 0.36 and 0.18 megapixels.
///
/// The first corner is next to a black outer square. If columns + rows is odd, this determines the
/// orientation of the board; if it is even, the orientation whose first corner is higher in the
/// image is returned, and `is_turn_known` is false.
TagDetectorEntry CheckerboardDetectorEntry();

}  // namespace sextant
