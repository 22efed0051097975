// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "base/random.h"

namespace sextant::test {

/// Adds normal noise of `sigma_grey` to the image, clamped at black and white.
inline void AddNoise(cv::Mat& image, double sigma_grey, std::uint64_t seed) {
  Random random(seed);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      auto& grey = image.at<std::uint8_t>(y, x);
      grey = cv::saturate_cast<std::uint8_t>(grey + sigma_grey * random.Normal());
    }
  }
}

}  // namespace sextant::test
