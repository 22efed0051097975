// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "features/camera/tag_detector.h"

namespace sextant {

/// Tags by the AprilTag 3 library (Wang and Olson 2016, "AprilTag 2", IROS; Krogius et al. 2019,
/// "Flexible layouts for fiducial tags", IROS), all families of apriltag_family.h.
///
/// The library's pixel (0, 0) is the corner of the top-left pixel, so half a pixel is subtracted;
/// without refine_edges, 0.055 px less and another 0.075 px less per step of decimation
/// (docs/detectors.md has the measurement).
TagDetectorEntry AprilTagDetectorEntry();

/// The tags of all families that are read without a wrong bit, in an 8-bit grey image, in one
/// search: the library reads each quadrilateral as a tag of every family.
std::vector<TagDetection> DetectAllAprilTags(const cv::Mat& grey);

}  // namespace sextant
