// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "base/error.h"

namespace sextant {

/// Converts an image to 8-bit grey; returns it without a copy if it is that already.
///
/// Accepts 8 or 16 bits in 1, 3 (BGR) or 4 (BGRA, alpha ignored) channels. 16 bits are divided by
/// the power of two that brings the brightest pixel under 256, since cameras store 10, 12, 14 or 16
/// bits in them. Error: kInvalidInput for other types and images under 16 x 16 pixels.
Expected<cv::Mat> ToGrey(const cv::Mat& image);

}  // namespace sextant
