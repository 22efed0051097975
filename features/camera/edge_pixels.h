// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "features/camera/edge_refine.h"

namespace sextant {

/// A pixel near an edge of a tag.
struct EdgePixel {
  Eigen::Vector2d straight_px;        ///< Where it is in the undistorted image.
  Eigen::Matrix2d straight_by_pixel;  ///< Maps the blur there.
  double grey = 0.0;
  int edge = 0;  ///< From corner `edge` to the next.
};

/// The pixels that RefineTag looks at, each once, for a tag with these corners.
std::vector<EdgePixel> CollectEdgePixels(const cv::Mat& grey, const Quad& corners_px,
                                         const TagPattern& pattern,
                                         const Undistortion& undistortion,
                                         const EdgeRefineOptions& options);

}  // namespace sextant
