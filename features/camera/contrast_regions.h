// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace sextant {

/// Rectangles that hold everything in an 8-bit grey image that a tag could be: where means of 4 x 4
/// pixels differ within 48 px by kTagContrast grey levels or more. They do not touch each other,
/// and reach 32 px and an eighth of their side beyond what differs, which is further than detectors
/// look for a tag's margin. Their corners are at multiples of 16 px (the image's right and lower
/// ends aside), where detectors that reduce the image or cut it into tiles would put theirs. One
/// pass over the image.
///
/// Where that leaves hardly anything out, or the image is small, the whole of it.
std::vector<cv::Rect> ContrastRegions(const cv::Mat& grey);

/// A tag with less between its black and white is not read: docs/detectors.md.
inline constexpr int kTagContrast = 8;

}  // namespace sextant
