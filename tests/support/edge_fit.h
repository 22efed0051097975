// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

namespace sextant::test {

/// Where an edge between two even areas crosses the rows or columns of an 8-bit image, whichever
/// it is steeper to, from the integral of grey levels across it: no threshold, no model of the
/// lens. `from` and `to` are on the edge to some pixels; the tenth at either end is left out.
/// Points are (x, y) in pixels.
std::vector<Eigen::Vector2d> EdgeCrossings(const cv::Mat& image, const Eigen::Vector2d& from,
                                           const Eigen::Vector2d& to, int half_width_px);

/// Corners of a four-sided dark area, from cubics through the crossings of its edges. `rough`: the
/// corners, clockwise, to a pixel or so.
std::vector<Eigen::Vector2d> FitQuadCorners(const cv::Mat& image,
                                            const std::vector<Eigen::Vector2d>& rough,
                                            int half_width_px);

}  // namespace sextant::test
