// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "features/camera/quad.h"
#include "features/camera/tags/tag_pattern.h"

namespace sextant {

/// Agreement of the cells of a tag in an image with its printed pattern.
struct TagReading {
  double margin = 0.0;  ///< Mean |grey - threshold| of the cells inside the border, grey levels.
  int wrong_cells = 0;  ///< Number of wrong cells inside the border.
};

/// Reads the centre of each cell inside `corners_px` (8-bit grey image). The threshold is midway
/// between the means of the cells that should be black and of those that should be white. Cells
/// outside the image count as wrong.
TagReading ReadTag(const cv::Mat& grey, const Quad& corners_px, const TagPattern& pattern);

}  // namespace sextant
