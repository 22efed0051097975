// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "features/camera/tag_pattern.h"

namespace sextant {

/// What a tag's pattern looks like through a Gaussian blur, at a point given in cells.
struct BlurredCell {
  double white = 0.0;                                  ///< 0 black, 1 white.
  Eigen::Vector2d by_point = Eigen::Vector2d::Zero();  ///< Derivative by the point in cells.
  double by_relative_blur = 0.0;                       ///< By the logarithm of the blur.
};

/// The pattern's cells, white all round, through a blur of the given standard deviations along the
/// tag's columns and rows [cells], and the correlation of the two: a blur that is round in the
/// image is skewed in the cells of a tag seen from the side.
///
/// sum c_ij over cells of the normal distribution's mass in the cell, the bivariate one by the
/// tetrachoric series (Pearson 1900) Phi(h) Phi(k) + phi(h) phi(k) sum rho^(n+1) / (n+1)! He_n(h)
/// He_n(k) up to rho^3. Exact along edges; the derivative by the blur leaves the series out.
BlurredCell BlurAt(const TagPattern& pattern, const Eigen::Vector2d& point_cells,
                   const Eigen::Vector2d& blur_cells, double correlation);

}  // namespace sextant
