// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/types.hpp>

namespace sextant::cli {

/// OpenCV's fixed point, for positions between pixels; it counts from pixel centres as we do.
inline constexpr int kFixedPointShift = 4;

inline cv::Point FixedPoint(const Eigen::Vector2d& pixel) {
  constexpr double kFar = 1e6;  // Beyond, the fixed point would overflow; it is off the image.
  const Eigen::Vector2d p = pixel.cwiseMax(-kFar).cwiseMin(kFar) * (1 << kFixedPointShift);
  return {cvRound(p.x()), cvRound(p.y())};
}

}  // namespace sextant::cli
