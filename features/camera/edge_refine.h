// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "base/error.h"
#include "features/camera/quad.h"
#include "features/camera/tags/tag_pattern.h"
#include "features/camera/undistortion.h"

namespace sextant {

using Matrix8d = Eigen::Matrix<double, 8, 8>;

struct EdgeRefineOptions {
  double band_px = 3.0;           ///< Pixels up to this distance from the tag's edges are used.
  double corner_radius_px = 1.5;  ///< Pixels this close to corners are not: print rounds them.
  double margin_cells = 1.0;      ///< Width of the white margin around the pattern.
  double max_move_px = 3.0;       ///< Maximum movement of a corner from its start.
  int max_iterations = 30;
};

struct RefinedTag {
  Quad corners_px{};                           ///< Order and origin as in TagDetection.
  Matrix8d covariance_px2 = Matrix8d::Zero();  ///< Order: x0, y0, x1, ..., y3.
  double blur_px = 0.0;        ///< Sigma of the blur of edges by lens, focus, motion and the pixel.
  double noise_grey = 0.0;     ///< Standard deviation of the residuals.
  double contrast_grey = 0.0;  ///< Difference between the tag's white and black.
};

/// Refines the corners of a tag from all pixels near the four edges of its border, to some
/// hundredths of a pixel.
///
/// Least squares over the grey levels I(p) = g(p) w(h(p)) + o(p): h is the homography from the
/// undistorted image to the tag's cells, where edges are straight and meet in the corners; w is the
/// printed pattern through a Gaussian blur (tag_model.h), which models neighbouring cells that are
/// only a pixel or two wide; g and o are planes, for uneven light. 15 unknowns: 8 of h, the blur,
/// 3 + 3 of g and o. Levenberg-Marquardt with Huber weights (Huber 1964) at 2.5 robust standard
/// deviations. The covariance is the residual variance times the inverse normal matrix; it is valid
/// for noise that is independent from pixel to pixel and for an image that was not sharpened.
///
/// Shapes: 8-bit grey image; start within about 2 px of the truth; pattern of the detected family
/// and id.
/// Errors: kDegenerate (start not convex, or an edge with fewer than 6 usable pixels: tag too small
/// or cut by the image's border); kNoConvergence (no minimum, a corner that moved further than
/// max_move_px, or no contrast: an edge is covered, or the pattern is that of another tag).
Expected<RefinedTag> RefineTag(const cv::Mat& grey, const Quad& start, const TagPattern& pattern,
                               const Undistortion& undistortion,
                               const EdgeRefineOptions& options = {});

}  // namespace sextant
