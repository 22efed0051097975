// SPDX-License-Identifier: Apache-2.0
#include "features/camera/marked_corners.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <set>
#include <vector>

#include "features/camera/contrast_regions.h"
#include "features/camera/find_boards.h"

namespace sextant {
namespace {

constexpr double kAdjacent = 0.8;  // In squares: 0.71 to the middle of an adjacent one.
constexpr int kMinHalfWindow_px = 2;
constexpr int kMaxHalfWindow_px = 11;
constexpr double kHalfWindow = 0.65;  // Share of the way to a tag: its diagonal just reaches it.
constexpr double kMaxMove = 0.5;      // Share of that distance.

cv::Point2d ToCv(const Eigen::Vector2d& point) { return {point.x(), point.y()}; }

// A corner of the checkerboard, and the tags of the squares that meet in it.
class MarkedCorner {
 public:
  MarkedCorner(const BoardChecker& checker, int column, int row, std::span<const BoardPoints> tags)
      : in_board_(checker.center_in_board_m +
                  checker.square_m * Eigen::Vector2d(column - 0.5 * (checker.inner_columns - 1),
                                                     row - 0.5 * (checker.inner_rows - 1))) {
    const bool first_is_white = ((row + column) % 2 == 1) != checker.starts_white;
    to_white_ = Eigen::Vector2d(1.0, first_is_white ? 1.0 : -1.0).normalized();
    for (const BoardPoints& tag : tags) {
      Eigen::Vector2d middle = Eigen::Vector2d::Zero();
      for (const Eigen::Vector2d& corner : tag.in_board_m) middle += 0.25 * corner;
      if ((middle - in_board_).norm() > kAdjacent * checker.square_m) continue;
      Add(tag);
    }
  }

  const Eigen::Vector2d& in_board() const { return in_board_; }

  /// None without a tag, or where the corner is not seen.
  std::optional<Eigen::Vector2d> Find(const cv::Mat& grey) const {
    if (in_plane_.empty()) return std::nullopt;
    const cv::Mat homography = cv::findHomography(in_plane_, pixels_);
    if (homography.empty()) return std::nullopt;
    const auto to_pixel = [&](const Eigen::Vector2d& p) -> Eigen::Vector2d {
      const cv::Mat q = homography * cv::Mat(cv::Matx31d(p.x(), p.y(), 1.0));
      return Eigen::Vector2d(q.at<double>(0), q.at<double>(1)) / q.at<double>(2);
    };
    const Eigen::Vector2d start = to_pixel(in_board_);
    double room_px = std::numeric_limits<double>::infinity();
    for (const cv::Point2d& pixel : pixels_) {
      room_px = std::min(room_px, std::hypot(pixel.x - start.x(), pixel.y - start.y()));
    }
    const int half = std::min(static_cast<int>(kHalfWindow * room_px), kMaxHalfWindow_px);
    if (half < kMinHalfWindow_px || !IsInside(grey, start, half + 1)) return std::nullopt;
    const Eigen::Vector2d corner = Refined(grey, start, half);
    if (!((corner - start).norm() < kMaxMove * room_px)) return std::nullopt;
    const double arm_m = 0.5 * gap_m_;
    const Eigen::Vector2d to_black(to_white_.x(), -to_white_.y());
    const auto level = [&](const Eigen::Vector2d& offset) {
      return LevelAt(grey, corner + to_pixel(in_board_ + offset) - start);
    };
    const double white = std::min(level(arm_m * to_white_), level(-arm_m * to_white_));
    const double black = std::max(level(arm_m * to_black), level(-arm_m * to_black));
    if (!(white - black >= kTagContrast)) return std::nullopt;
    return corner;
  }

 private:
  void Add(const BoardPoints& tag) {
    for (std::size_t i = 0; i < tag.in_board_m.size(); ++i) {
      in_plane_.push_back(ToCv(tag.in_board_m[i]));
      pixels_.push_back(ToCv(tag.pixels[i]));
      gap_m_ = std::min(gap_m_, (tag.in_board_m[i] - in_board_).norm());
    }
  }

  static bool IsInside(const cv::Mat& grey, const Eigen::Vector2d& pixel, double margin) {
    return pixel.x() >= margin && pixel.y() >= margin && pixel.x() < grey.cols - margin &&
           pixel.y() < grey.rows - margin;
  }

  static Eigen::Vector2d Refined(const cv::Mat& grey, const Eigen::Vector2d& start, int half) {
    std::vector<cv::Point2f> corner = {static_cast<cv::Point2f>(ToCv(start))};
    const cv::TermCriteria until(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 30, 0.01);
    cv::cornerSubPix(grey, corner, cv::Size(half, half), cv::Size(-1, -1), until);
    return {corner[0].x, corner[0].y};
  }

  // Not a number outside the image.
  static double LevelAt(const cv::Mat& grey, const Eigen::Vector2d& pixel) {
    if (!IsInside(grey, pixel, 1.0)) return std::numeric_limits<double>::quiet_NaN();
    cv::Mat patch;
    cv::getRectSubPix(grey, cv::Size(1, 1), static_cast<cv::Point2f>(ToCv(pixel)), patch);
    return patch.at<std::uint8_t>(0, 0);
  }

  Eigen::Vector2d in_board_;
  Eigen::Vector2d to_white_ = Eigen::Vector2d::UnitX();
  std::vector<cv::Point2d> in_plane_;
  std::vector<cv::Point2d> pixels_;
  double gap_m_ = std::numeric_limits<double>::infinity();
};

}  // namespace

BoardPoints FindMarkedCorners(const cv::Mat& grey, const BoardChecker& checker,
                              std::span<const BoardPoints> tags) {
  BoardPoints found;
  std::set<int> rows;
  std::set<int> columns;
  for (int row = 0; row < checker.inner_rows; ++row) {
    for (int column = 0; column < checker.inner_columns; ++column) {
      const MarkedCorner corner(checker, column, row, tags);
      const std::optional<Eigen::Vector2d> pixel = corner.Find(grey);
      if (!pixel) continue;
      found.in_board_m.push_back(corner.in_board());
      found.pixels.push_back(*pixel);
      rows.insert(row);
      columns.insert(column);
    }
  }
  if (rows.size() < 2 || columns.size() < 2) return {};
  const auto size = 2 * std::ssize(found.pixels);
  found.covariance_px2 =
      kCheckerSigma_px * kCheckerSigma_px * Eigen::MatrixXd::Identity(size, size);
  return found;
}

}  // namespace sextant
