// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace sextant {

/// Rectangles that contain every part of an 8-bit grey image that may be a tag: parts in which
/// means of 4 x 4 pixels differ within 48 px by at least kTagContrast grey levels. The rectangles
/// are disjoint and extend 32 px and an eighth of their side beyond such parts, more than the
/// margin that detectors need around a tag. Their corners are at multiples of 16 px (except at the
/// right and lower ends of the image), aligned with the tiles of detectors that decimate the image
/// or divide it into tiles. Takes one pass over the image.
///
/// If the rectangles would cover most of the image, or the image is small, returns the whole image.
std::vector<cv::Rect> ContrastRegions(const cv::Mat& grey);

/// Tags with less contrast between black and white are not detected: docs/detectors.md.
inline constexpr int kTagContrast = 8;

}  // namespace sextant
