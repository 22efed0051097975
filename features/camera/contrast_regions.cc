// SPDX-License-Identifier: Apache-2.0
#include "features/camera/contrast_regions.h"

#include <algorithm>
#include <cstdint>
#include <opencv2/imgproc.hpp>

namespace sextant {
namespace {

constexpr int kReduction = 4;
constexpr int kTile = 4;  ///< Reduced pixels.
constexpr int kTile_px = kReduction * kTile;
constexpr int kMinSide_px = 160;
constexpr double kMaxShare = 0.7;  ///< Fraction of the image above which one call is cheaper.

// The range of the reduced image within each tile and its neighbours.
cv::Mat RangesOfTiles(const cv::Mat& grey) {
  cv::Mat reduced;
  cv::resize(grey(cv::Rect(0, 0, grey.cols / kReduction * kReduction,
                           grey.rows / kReduction * kReduction)),
             reduced, {grey.cols / kReduction, grey.rows / kReduction}, 0.0, 0.0, cv::INTER_AREA);
  const int columns = (reduced.cols + kTile - 1) / kTile;
  const int rows = (reduced.rows + kTile - 1) / kTile;
  cv::Mat least(rows, columns, CV_8U, cv::Scalar(255));
  cv::Mat most(rows, columns, CV_8U, cv::Scalar(0));
  for (int y = 0; y < reduced.rows; ++y) {
    const std::uint8_t* row = reduced.ptr<std::uint8_t>(y);
    std::uint8_t* low = least.ptr<std::uint8_t>(y / kTile);
    std::uint8_t* high = most.ptr<std::uint8_t>(y / kTile);
    for (int x = 0; x < reduced.cols; ++x) {
      low[x / kTile] = std::min(low[x / kTile], row[x]);
      high[x / kTile] = std::max(high[x / kTile], row[x]);
    }
  }
  cv::erode(least, least, {});
  cv::dilate(most, most, {});
  return most - least;
}

// Bounds, in tiles, of the connected parts with contrast, enlarged by the margin of a tag of that
// size.
std::vector<cv::Rect> BoundsOfParts(const cv::Mat& ranges) {
  constexpr int kMarginsPerSide = 8;
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat middles;
  const int count =
      cv::connectedComponentsWithStats(ranges >= kTagContrast, labels, stats, middles);
  std::vector<cv::Rect> bounds;
  for (int i = 1; i < count; ++i) {
    const cv::Rect part(stats.at<int>(i, cv::CC_STAT_LEFT), stats.at<int>(i, cv::CC_STAT_TOP),
                        stats.at<int>(i, cv::CC_STAT_WIDTH), stats.at<int>(i, cv::CC_STAT_HEIGHT));
    const int margin = 1 + std::max(part.width, part.height) / kMarginsPerSide;
    bounds.push_back(part + cv::Size(2 * margin, 2 * margin) - cv::Point(margin, margin));
  }
  return bounds;
}

// Replaces overlapping rectangles by their common bounds until none overlap. Those before `i` are
// disjoint from all others; one that has grown is compared with them again. O(n^2), as for each
// comparison with all others a rectangle is passed or removed.
void Merge(std::vector<cv::Rect>& rectangles) {
  for (std::size_t i = 0; i < rectangles.size();) {
    std::size_t other = 0;
    while (other < rectangles.size() &&
           (other == i || (rectangles[i] & rectangles[other]).area() == 0)) {
      ++other;
    }
    if (other == rectangles.size()) {
      ++i;
      continue;
    }
    rectangles[i] |= rectangles[other];
    rectangles.erase(rectangles.begin() + static_cast<std::ptrdiff_t>(other));
    if (other < i) --i;
  }
}

}  // namespace

std::vector<cv::Rect> ContrastRegions(const cv::Mat& grey) {
  const cv::Rect whole(0, 0, grey.cols, grey.rows);
  if (std::min(grey.cols, grey.rows) < kMinSide_px) return {whole};
  std::vector<cv::Rect> regions = BoundsOfParts(RangesOfTiles(grey));
  Merge(regions);
  double area = 0.0;
  for (cv::Rect& region : regions) {
    region = cv::Rect(region.x * kTile_px, region.y * kTile_px, region.width * kTile_px,
                      region.height * kTile_px);
    // The reduction may have cut off the last tiles.
    if (region.br().x + kTile_px > grey.cols) region.width = grey.cols - region.x;
    if (region.br().y + kTile_px > grey.rows) region.height = grey.rows - region.y;
    region &= whole;
    area += region.area();
  }
  if (area > kMaxShare * whole.area()) return {whole};
  return regions;
}

}  // namespace sextant
