// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

namespace sextant {

/// A square tag in an image. Pixel (0, 0) is the centre of the top-left pixel.
struct TagDetection {
  std::string family{};  ///< As in BoardTag; the path of the dictionary if it was read from a file.
  int id = 0;
  /// Corners of the square that TagPattern::edge_first defines: the tag's own top-left, top-right,
  /// bottom-right, bottom-left, clockwise in the image.
  std::array<Eigen::Vector2d, 4> corners_px{};
  /// Mean distance [grey levels] of the data cells from the threshold between black and white; low
  /// for false, small or blurred tags.
  double decision_margin = 0.0;
  int hamming = 0;  ///< Data cells that were read wrongly and corrected.
};

/// The inner corners of a checkerboard, row by row. The direction to the next row is clockwise from
/// the direction along a row: their cross product points away from the camera.
struct CheckerDetection {
  int inner_columns = 0;
  int inner_rows = 0;
  std::vector<Eigen::Vector2d> corners_px{};
  /// Whether the first corner's outer square is black, as BoardChecker defines it, and no rotation
  /// of the board looks the same. Otherwise the board rotated by 180 degrees also fits the image.
  bool is_turn_known = false;
};

struct Detections {
  std::vector<TagDetection> tags{};  ///< By family, then id, then position.
  std::vector<CheckerDetection> checkers{};
};

}  // namespace sextant
