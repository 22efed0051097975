// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "features/camera/tag_detector.h"

namespace sextant {

/// Tags by the AprilTag 3 library (Wang and Olson 2016, "AprilTag 2", IROS; Krogius et al. 2019,
/// "Flexible layouts for fiducial tags", IROS), all families of apriltag_family.h.
///
/// The library counts pixels from the corner of the first, so half a pixel is taken away; without
/// refine_edges its quads are 0.055 px and a further 0.075 px a step of decimation short of that
/// (docs/detectors.md has the measurement).
TagDetectorEntry AprilTagDetectorEntry();

}  // namespace sextant
