// SPDX-License-Identifier: Apache-2.0
#include "features/camera/tag_reading.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace sextant {
namespace {

struct Cell {
  double grey = -1.0;  ///< Negative outside the image.
  bool is_white = false;
  bool is_data = false;
};

// Bilinear; negative outside the image.
double GreyAt(const cv::Mat& grey, const Eigen::Vector2d& pixel) {
  const int x = static_cast<int>(std::floor(pixel.x()));
  const int y = static_cast<int>(std::floor(pixel.y()));
  if (x < 0 || y < 0 || x + 1 >= grey.cols || y + 1 >= grey.rows) return -1.0;
  const double fx = pixel.x() - x;
  const double fy = pixel.y() - y;
  const std::uint8_t* above = grey.ptr<std::uint8_t>(y) + x;
  const std::uint8_t* below = grey.ptr<std::uint8_t>(y + 1) + x;
  return (1.0 - fy) * ((1.0 - fx) * above[0] + fx * above[1]) +
         fy * ((1.0 - fx) * below[0] + fx * below[1]);
}

std::vector<Cell> ReadCells(const cv::Mat& grey, const Eigen::Matrix3d& pixel_from_unit,
                            const TagPattern& pattern) {
  std::vector<Cell> cells;
  const int edge = pattern.edge_cells;
  for (int row = 0; row < edge; ++row) {
    for (int column = 0; column < edge; ++column) {
      const Eigen::Vector2d unit((column + 0.5) / edge, (row + 0.5) / edge);
      const Eigen::Vector2d pixel = (pixel_from_unit * unit.homogeneous()).hnormalized();
      const bool on_border = row == 0 || column == 0 || row == edge - 1 || column == edge - 1;
      cells.push_back(
          {.grey = GreyAt(grey, pixel),
           .is_white = pattern.IsWhite(row + pattern.edge_first, column + pattern.edge_first),
           .is_data = !on_border});
    }
  }
  return cells;
}

double MeanOf(const std::vector<Cell>& cells, bool is_white, double default_value) {
  double sum = 0.0;
  int count = 0;
  for (const Cell& cell : cells) {
    if (cell.is_white != is_white || cell.grey < 0.0) continue;
    sum += cell.grey;
    ++count;
  }
  return count > 0 ? sum / count : default_value;
}

}  // namespace

TagReading ReadTag(const cv::Mat& grey, const Quad& corners_px, const TagPattern& pattern) {
  const std::optional<Eigen::Matrix3d> pixel_from_unit = UnitSquareToQuad(corners_px);
  const int data_side = std::max(pattern.edge_cells - 2, 0);
  TagReading reading{.margin = 0.0, .wrong_cells = data_side * data_side};
  if (!pixel_from_unit || data_side == 0) return reading;
  const std::vector<Cell> cells = ReadCells(grey, *pixel_from_unit, pattern);
  const double threshold = 0.5 * (MeanOf(cells, true, 255.0) + MeanOf(cells, false, 0.0));
  double distances = 0.0;
  for (const Cell& cell : cells) {
    if (!cell.is_data || cell.grey < 0.0) continue;
    if ((cell.grey > threshold) == cell.is_white) --reading.wrong_cells;
    distances += std::abs(cell.grey - threshold);
  }
  reading.margin = distances / (data_side * data_side);
  return reading;
}

}  // namespace sextant
