// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

namespace sextant {

/// A square tag in an image. Pixel (0, 0) is the centre of the top-left pixel.
struct TagDetection {
  std::string family{};  ///< As BoardTag names it; a dictionary's file, where it came from one.
  int id = 0;
  /// Of the square that TagPattern::edge_first begins: the tag's own top-left, top-right,
  /// bottom-right, bottom-left, which is clockwise as the camera sees it.
  std::array<Eigen::Vector2d, 4> corners_px{};
  /// Mean distance [grey levels] of the data cells from the threshold between black and white: low
  /// for false, small or blurred tags.
  double decision_margin = 0.0;
  int hamming = 0;  ///< Data cells that were read wrongly and corrected.
};

/// The inner corners of a checkerboard, row by row. Rows follow each other clockwise from columns:
/// (along a row) x (to the next row) points away from the camera.
struct CheckerDetection {
  int inner_columns = 0;
  int inner_rows = 0;
  std::vector<Eigen::Vector2d> corners_px{};
  /// Whether the first corner's outer square is black, as BoardChecker has it, and no turn of the
  /// board looks the same. Otherwise the same board turned by 180 degrees explains the image too.
  bool is_turn_known = false;
};

struct Detections {
  std::vector<TagDetection> tags{};  ///< By family, then id, then position.
  std::vector<CheckerDetection> checkers{};
};

}  // namespace sextant
