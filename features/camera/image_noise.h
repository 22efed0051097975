// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace sextant {

/// Standard deviation of the noise of single pixels [grey levels] in an 8-bit grey image: from the
/// second differences along rows, which see neither light nor slopes, of blocks of 16 x 16 pixels.
/// The lower quartile of the blocks counts, so that print and edges in three quarters of them do no
/// harm; blocks without any difference (black, or overexposed) do not count. Noise that goes
/// together over neighbouring pixels is told too small; texture finer than some pixels that fills
/// the image is told as noise. 0 where there is no block or no difference.
double EstimateNoiseGrey(const cv::Mat& grey);

}  // namespace sextant
