// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "features/camera/tag_detector.h"

namespace sextant {

/// Tags by OpenCV's aruco module (Garrido-Jurado et al. 2014, Pattern Recognition 47), all of its
/// dictionaries or one from a file.
///
/// Corrections of OpenCV 4.6's corners (docs/detectors.md has the measurement): with refinement
/// `none` and `contour` they are centres of the outermost black pixels, so each edge is moved out
/// by half a pixel's extent across it; `subpix` moves corners slightly inward; in `apriltag` pixel
/// (0, 0) is the corner of the top-left pixel.
TagDetectorEntry ArucoDetectorEntry();

}  // namespace sextant
