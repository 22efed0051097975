// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "base/error.h"

namespace sextant {

/// The image in 8 bits of grey, itself where it is that already (no copy).
///
/// Takes 8 or 16 bits in 1, 3 (BGR) or 4 (BGRA, alpha not looked at) channels. 16 bits are divided
/// by the power of two that brings the brightest pixel under 256, as cameras store 10, 12, 14 or 16
/// bits in them. Error: kInvalidInput for other types and images under 16 x 16 pixels.
Expected<cv::Mat> ToGrey(const cv::Mat& image);

}  // namespace sextant
