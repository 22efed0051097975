// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace sextant {

/// Estimates the standard deviation of the noise of single pixels [grey levels] in an 8-bit grey
/// image, from second differences along rows, which cancel brightness and gradients, in blocks of
/// 16 x 16 pixels. The lower quartile over the blocks is used, so print and edges in up to three
/// quarters of them have no effect; blocks without any difference (black or overexposed) are
/// skipped. Noise that is correlated between neighbouring pixels is underestimated; fine texture
/// that fills the image is mistaken for noise. 0 if there is no block or no difference.
double EstimateNoiseGrey(const cv::Mat& grey);

}  // namespace sextant
