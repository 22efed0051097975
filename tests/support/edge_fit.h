// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

namespace sextant::test {

/// Intersections of an edge between two uniform areas with the rows or columns of an 8-bit image,
/// whichever are steeper to it. They are computed from the integral of grey levels across the edge,
/// without a threshold or a lens model. `from` and `to` are on the edge to within some pixels; a
/// tenth at either end is left out. Points are (x, y) in pixels.
std::vector<Eigen::Vector2d> EdgeCrossings(const cv::Mat& image, const Eigen::Vector2d& from,
                                           const Eigen::Vector2d& to, int half_width_px);

/// Corners of a dark quadrilateral, from cubics through the intersections of its edges. `rough`:
/// the corners, clockwise, to about a pixel.
std::vector<Eigen::Vector2d> FitQuadCorners(const cv::Mat& image,
                                            const std::vector<Eigen::Vector2d>& rough,
                                            int half_width_px);

}  // namespace sextant::test
