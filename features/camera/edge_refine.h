// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "base/error.h"
#include "features/camera/quad.h"
#include "features/camera/tag_pattern.h"
#include "features/camera/undistortion.h"

namespace sextant {

using Matrix8d = Eigen::Matrix<double, 8, 8>;

struct EdgeRefineOptions {
  double band_px = 3.0;           ///< Pixels this far from the tag's edges are looked at.
  double corner_radius_px = 1.5;  ///< Less those this near to its corners, which print rounds off.
  double margin_cells = 1.0;      ///< Width of the white that surrounds the pattern.
  double max_move_px = 3.0;       ///< Of a corner from its start.
  int max_iterations = 30;
};

struct RefinedTag {
  Quad corners_px{};                           ///< Order and origin as TagDetection's.
  Matrix8d covariance_px2 = Matrix8d::Zero();  ///< Of (x0, y0, x1, y1, ..., y3).
  double blur_px = 0.0;     ///< Sigma of an edge's rise: lens, focus, motion and the pixel itself.
  double noise_grey = 0.0;  ///< Standard deviation of the residuals.
  double contrast_grey = 0.0;  ///< Between the tag's white and black.
};

/// Corners of a tag from all pixels near the four edges of its border, to some hundredths of a
/// pixel.
///
/// Least squares over the grey levels I(p) = g(p) w(h(p)) + o(p): h the homography from the
/// undistorted image to the tag's cells, so that edges are straight there and meet in its corners;
/// w the printed cells through a Gaussian blur (tag_model.h), which tells the steps of
/// neighbouring cells apart where a cell is only a pixel or two wide; g and o planes, for uneven
/// light. 15 unknowns: 8 of h, the blur, 3 + 3 of g and o. Levenberg-Marquardt with Huber weights
/// (Huber 1964) at 2.5 robust standard deviations. The covariance is the residual variance times
/// the inverse normal matrix, so it holds for noise that is independent from pixel to pixel and an
/// image that was not sharpened.
///
/// Shapes: 8-bit grey image; start within about 2 px of the truth; pattern of the detected family
/// and id.
/// Errors: kDegenerate (start not convex, or an edge with fewer than 6 pixels to look at: tag too
/// small, or cut by the image's border); kNoConvergence (no minimum, a corner that moved further
/// than max_move_px, or no contrast: something covers an edge, or the pattern is another's).
Expected<RefinedTag> RefineTag(const cv::Mat& grey, const Quad& start, const TagPattern& pattern,
                               const Undistortion& undistortion,
                               const EdgeRefineOptions& options = {});

}  // namespace sextant
