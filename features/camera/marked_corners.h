// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <span>

#include "geometry/board.h"
#include "geometry/board_view.h"

namespace sextant {

/// Finds the inner corners of a checkerboard whose white squares hold tags (ChArUco; Garrido-Jurado
/// et al. 2014). `tags`: the four corners of each tag of the board that was found.
///
/// A corner is predicted by the homography of the one or two tags in the squares that meet in it,
/// and moved to the point at which the gradients around it are orthogonal to the lines to it
/// (cornerSubPix), in a window without any of a tag. It is omitted where it moves too far, or where
/// its squares are not dark and bright as they should be. The covariance is that of a checkerboard.
/// Empty unless the corners are on two rows and two columns at least.
BoardPoints FindMarkedCorners(const cv::Mat& grey, const BoardChecker& checker,
                              std::span<const BoardPoints> tags);

}  // namespace sextant
