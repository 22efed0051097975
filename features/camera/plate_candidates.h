// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "features/camera/quad.h"

namespace sextant {

/// A convex region of an image with four straight sides; corners may be outside the image.
struct PlateCandidate {
  struct Side {
    Eigen::Vector2d from = Eigen::Vector2d::Zero();  ///< In the image, on the side [px].
    Eigen::Vector2d to = Eigen::Vector2d::Zero();
  };
  std::array<Side, 4> sides{};  ///< Clockwise as seen; a few pixels off.
  bool is_brighter = true;      ///< Than what surrounds it.
};

/// The regions that are brighter or darker than one of many levels and have four straight sides
/// within the image. Similar ones of several levels are all listed. Requires 8-bit grey.
std::vector<PlateCandidate> FindPlateCandidates(const cv::Mat& grey);

/// The corners in which neighbouring sides meet, corner i where side i begins; none for parallel
/// ones and where they are not convex.
std::optional<Quad> CornersOf(const PlateCandidate& candidate);

}  // namespace sextant
