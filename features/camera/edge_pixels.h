// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "features/camera/edge_refine.h"

namespace sextant {

/// Pixels near the edges of a tag as a structure of arrays, padded with copies of the last to a
/// multiple of kSimdWidth.
struct EdgePixels {
  std::vector<double> x, y;            ///< Positions in the undistorted image [px].
  std::vector<double> x_by_u, x_by_v;  ///< Derivatives of the position by the pixel (u, v).
  std::vector<double> y_by_u, y_by_v;
  std::vector<double> grey;
  Eigen::Index count = 0;        ///< Number of pixels without the padding.
  std::array<int, 4> on_edge{};  ///< Number of pixels nearest to the edge from corner i to i + 1.
};

/// Collects the pixels that RefineTag uses, each once, for a tag with these corners.
EdgePixels CollectEdgePixels(const cv::Mat& grey, const Quad& corners_px, const TagPattern& pattern,
                             const Undistortion& undistortion, const EdgeRefineOptions& options);

}  // namespace sextant
