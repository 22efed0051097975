// SPDX-License-Identifier: Apache-2.0
#include "features/camera/checkerboard_detector.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace sextant {
namespace {

struct CheckerOptions {
  int columns = 7;
  int rows = 5;
  bool accurate = false;
  bool subpix = true;
};

OptionSet<CheckerOptions> CheckerOptionSet() {
  OptionSet<CheckerOptions> options;
  options.Count("columns", &CheckerOptions::columns, 3, 1000, "inner corners along x")
      .Count("rows", &CheckerOptions::rows, 3, 1000, "inner corners along y")
      .Choice("accurate", &CheckerOptions::accurate, {"false", "true"},
              "sample sectors on an enlarged image")
      .Choice("subpix", &CheckerOptions::subpix, {"false", "true"},
              "refine each corner by the gradients of the grey levels");
  return options;
}

// Mean grey level of the outer square at a corner, found by continuing the line from the next inner
// corner on the diagonal through this corner.
double OuterSquareGrey(const cv::Mat& grey, const Eigen::Vector2d& corner,
                       const Eigen::Vector2d& next_diagonal) {
  const Eigen::Vector2d middle = corner - 0.5 * (next_diagonal - corner);
  const int x = std::clamp(static_cast<int>(std::lround(middle.x())), 1, grey.cols - 2);
  const int y = std::clamp(static_cast<int>(std::lround(middle.y())), 1, grey.rows - 2);
  return cv::mean(grey(cv::Rect(x - 1, y - 1, 3, 3)))[0];
}

// Brings the corners into the order of CheckerDetection.
void Orient(const cv::Mat& grey, CheckerDetection& found) {
  std::vector<Eigen::Vector2d>& corners = found.corners_px;
  const auto columns = static_cast<std::ptrdiff_t>(found.inner_columns);
  const auto at = [&](std::ptrdiff_t row, std::ptrdiff_t column) {
    return corners[static_cast<std::size_t>(row * columns + column)];
  };
  const Eigen::Vector2d along = at(0, columns - 1) - at(0, 0);
  const Eigen::Vector2d across = corners.back() - at(0, columns - 1);
  if (along.x() * across.y() - along.y() * across.x() < 0.0) {
    for (auto row = corners.begin(); row != corners.end(); row += columns) {
      std::reverse(row, row + columns);
    }
  }
  found.is_turn_known = (found.inner_columns + found.inner_rows) % 2 == 1;
  const double first = OuterSquareGrey(grey, corners[0], at(1, 1));
  const double last = OuterSquareGrey(grey, corners.back(), at(found.inner_rows - 2, columns - 2));
  const bool turn = found.is_turn_known ? last < first : corners.back().y() < corners.front().y();
  if (turn) std::reverse(corners.begin(), corners.end());
}

// The smallest distance between neighbours of a row or column [px].
double SmallestSpacing(int columns, const std::vector<cv::Point2f>& corners) {
  double spacing = std::numeric_limits<double>::infinity();
  const auto stride = static_cast<std::size_t>(columns);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (i % stride > 0) spacing = std::min(spacing, cv::norm(corners[i] - corners[i - 1]));
    if (i >= stride) spacing = std::min(spacing, cv::norm(corners[i] - corners[i - stride]));
  }
  return spacing;
}

// Refines the corners in windows that contain no other corner.
void RefineBySubpix(const cv::Mat& grey, int columns, std::vector<cv::Point2f>& corners) {
  constexpr int kLargestHalf_px = 11;
  constexpr double kHalfOfSpacing = 0.4;
  const double spacing = SmallestSpacing(columns, corners);
  const int half = std::clamp(static_cast<int>(kHalfOfSpacing * spacing), 2, kLargestHalf_px);
  const cv::TermCriteria until(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 30, 0.01);
  cv::cornerSubPix(grey, corners, cv::Size(half, half), cv::Size(-1, -1), until);
}

constexpr int kThorough = cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE;

// OpenCV's detector, whose time grows with the number of pixels.
bool FindCorners(const cv::Mat& grey, const cv::Size& size, int flags,
                 std::vector<cv::Point2f>& corners) {
  // Normalising the image loses boards of low contrast but finds others in uneven light, so it
  // is the second attempt.
  return cv::findChessboardCornersSB(grey, size, corners, flags) ||
         cv::findChessboardCornersSB(grey, size, corners, flags | kThorough);
}

struct Reduced {
  double scale = 0.5;  // Factor of the sides.
  int flags = 0;
  double min_spacing_px = 10.0;
};

// Corners to about a pixel, from a smaller image; false where it has none, or where the squares are
// so small there that they should be searched for in the whole image.
bool FindReduced(const cv::Mat& grey, const cv::Size& size, const Reduced& reduced,
                 std::vector<cv::Point2f>& corners) {
  cv::Mat smaller;
  cv::resize(grey, smaller, {}, reduced.scale, reduced.scale, cv::INTER_AREA);
  if (!cv::findChessboardCornersSB(smaller, size, corners, reduced.flags)) return false;
  if (SmallestSpacing(size.width, corners) < reduced.min_spacing_px) return false;
  const auto scale = static_cast<float>(reduced.scale);
  const float shift = 0.5F / scale - 0.5F;
  for (cv::Point2f& corner : corners) corner = corner / scale + cv::Point2f(shift, shift);
  return true;
}

// Much detail, in which the detector loses a board, is gone in a small image.
bool FindAmongDetail(const cv::Mat& grey, const cv::Size& size, std::vector<cv::Point2f>& corners) {
  for (const double pixels : {360e3, 180e3}) {
    const Reduced reduced{.scale = std::sqrt(pixels / static_cast<double>(grey.total())),
                          .flags = kThorough,
                          .min_spacing_px = 5.0};
    if (reduced.scale < 0.8 && FindReduced(grey, size, reduced, corners)) return true;
  }
  return false;
}

class CheckerboardDetector final : public TagDetector {
 public:
  CheckerboardDetector(std::string name, const CheckerOptions& options)
      : TagDetector(std::move(name)), options_(options) {}

 private:
  Detections DoDetect(const cv::Mat& grey) const override {
    const int accuracy = options_.accurate ? cv::CALIB_CB_ACCURACY : 0;
    std::vector<cv::Point2f> corners;
    const cv::Size size(options_.columns, options_.rows);
    // The grey levels of the whole image give the corners in the end.
    constexpr std::size_t kLarge_px = 1'000'000;
    const bool may_reduce = options_.subpix && !options_.accurate;
    const bool is_found =
        (may_reduce && grey.total() >= kLarge_px && FindReduced(grey, size, {}, corners)) ||
        FindCorners(grey, size, accuracy, corners) ||
        (may_reduce && FindAmongDetail(grey, size, corners));
    if (!is_found) return {};
    if (options_.subpix) RefineBySubpix(grey, options_.columns, corners);
    CheckerDetection found{.inner_columns = options_.columns, .inner_rows = options_.rows};
    for (const cv::Point2f& corner : corners) found.corners_px.emplace_back(corner.x, corner.y);
    Orient(grey, found);
    return {.tags = {}, .checkers = {std::move(found)}};
  }

  CheckerOptions options_;
};

}  // namespace

TagDetectorEntry CheckerboardDetectorEntry() {
  return {
      .name = "checkerboard",
      .summary = "OpenCV's sector-based detector of checkerboards",
      .example = "checkerboard(columns=7,rows=5)",
      .options = CheckerOptionSet().Describe(),
      .make = [](const std::string& name, const OptionValues& values) -> Expected<TagDetectorPtr> {
        SEXTANT_ASSIGN_OR_RETURN(const CheckerOptions options, CheckerOptionSet().Parse(values));
        return std::make_shared<CheckerboardDetector>(name, options);
      }};
}

}  // namespace sextant
