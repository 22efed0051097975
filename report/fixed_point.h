// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/types.hpp>

namespace sextant {

/// OpenCV's fixed-point coordinates, for positions between pixels; as ours, they are relative to
/// pixel centres.
inline constexpr int kFixedPointShift = 4;

inline cv::Point FixedPoint(const Eigen::Vector2d& pixel) {
  constexpr double kFar = 1e6;  // Farther positions are outside any image and would overflow.
  const Eigen::Vector2d p = pixel.cwiseMax(-kFar).cwiseMin(kFar) * (1 << kFixedPointShift);
  return {cvRound(p.x()), cvRound(p.y())};
}

}  // namespace sextant
