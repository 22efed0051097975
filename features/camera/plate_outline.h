// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "features/camera/quad.h"
#include "geometry/board.h"
#include "geometry/camera.h"

namespace sextant {

/// The outline of a plain plate in an image.
struct PlateOutline {
  /// Those of the board, in its order; intersections of the sides, which may be outside the image.
  /// Nothing shows which of 2 orientations (4 of a square) is the board's: corner 0 is the highest.
  Quad corners_px{};
  /// In the order (x0, y0, x1, ...) [px^2]: neighbouring corners share a side.
  Eigen::Matrix<double, 8, 8> covariance_px2 = Eigen::Matrix<double, 8, 8>::Zero();
};

/// Whether a board has no print, so that its outline is all that an image shows.
bool IsPlain(const Board& board);

/// Finds what may be a plain plate of the board's size: a region of even grey with four straight
/// sides, each seen along more than half of its length within the image, in the perspective of a
/// rectangle with these sides. Larger ones first; the same outline is listed once. Two of them
/// cannot be told apart by the image alone. Requires 8-bit grey.
std::vector<PlateOutline> FindPlateOutlines(const cv::Mat& grey, const Camera& camera,
                                            const Board& board);

}  // namespace sextant
