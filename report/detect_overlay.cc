// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <opencv2/imgproc.hpp>

#include "features/camera/grey_image.h"
#include "report/detect_report.h"
#include "report/fixed_point.h"

namespace sextant {
namespace {

const cv::Scalar kTag(0, 200, 0);
const cv::Scalar kStranger(160, 160, 160);
const cv::Scalar kBoardOutline(0, 160, 255);
const cv::Scalar kFirstCorner(0, 0, 255);

void DrawLine(cv::Mat& canvas, const Eigen::Vector2d& a, const Eigen::Vector2d& b,
              const cv::Scalar& colour) {
  cv::line(canvas, FixedPoint(a), FixedPoint(b), colour, 2, cv::LINE_AA, kFixedPointShift);
}

void DrawTag(cv::Mat& canvas, const Quad& corners, const std::string& label,
             const cv::Scalar& colour) {
  for (std::size_t k = 0; k < 4; ++k) DrawLine(canvas, corners[k], corners[(k + 1) % 4], colour);
  cv::circle(canvas, FixedPoint(corners[0]), 5 << kFixedPointShift, kFirstCorner, 2, cv::LINE_AA,
             kFixedPointShift);
  const Eigen::Vector2d middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  cv::putText(canvas, label, {cvRound(middle.x()), cvRound(middle.y())}, cv::FONT_HERSHEY_SIMPLEX,
              0.7, kFirstCorner, 2, cv::LINE_AA);
}

// Drawn in pieces, because a straight edge of the board is curved in a distorted image.
void DrawEdge(cv::Mat& canvas, const Camera& camera, const Eigen::Vector3d& a,
              const Eigen::Vector3d& b) {
  constexpr int kPieces = 16;
  std::optional<Eigen::Vector2d> last = Project(camera, a);
  for (int i = 1; i <= kPieces; ++i) {
    const double share = static_cast<double>(i) / kPieces;
    const std::optional<Eigen::Vector2d> next = Project(camera, (1.0 - share) * a + share * b);
    if (last && next) DrawLine(canvas, *last, *next, kBoardOutline);
    last = next;
  }
}

void DrawCorners(cv::Mat& canvas, const std::vector<Eigen::Vector2d>& corners_px) {
  for (const Eigen::Vector2d& corner : corners_px) {
    cv::circle(canvas, FixedPoint(corner), 4 << kFixedPointShift, kTag, 2, cv::LINE_AA,
               kFixedPointShift);
  }
}

void DrawBoard(cv::Mat& canvas, const Camera& camera, const SeenBoard& seen) {
  const std::vector<Eigen::Vector3d>& corners = seen.corners.points;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const std::size_t first_of_rectangle = k / 4 * 4;
    DrawEdge(canvas, camera, corners[k], corners[first_of_rectangle + (k + 1) % 4]);
    if (const auto pixel = Project(camera, corners[k])) {
      cv::putText(canvas, std::to_string(k), {cvRound(pixel->x()) + 6, cvRound(pixel->y())},
                  cv::FONT_HERSHEY_SIMPLEX, 0.6, kBoardOutline, 2, cv::LINE_AA);
    }
  }
}

}  // namespace

cv::Mat DrawDetection(const cv::Mat& image, const ImageReport& report,
                      const std::vector<Board>& boards, const std::optional<Camera>& camera) {
  cv::Mat canvas;
  cv::cvtColor(*ToGrey(image), canvas, cv::COLOR_GRAY2BGR);
  for (const TagDetection& tag : report.seen.other_tags) {
    DrawTag(canvas, tag.corners_px, std::to_string(tag.id), boards.empty() ? kTag : kStranger);
  }
  for (const CheckerDetection& checker : report.checkers) DrawCorners(canvas, checker.corners_px);
  for (const SeenBoard& seen : report.seen.boards) {
    for (const SeenTag& tag : seen.tags) {
      DrawTag(canvas, tag.refined ? tag.refined->corners_px : tag.detection.corners_px,
              std::to_string(tag.detection.id), kTag);
    }
    if (seen.checker) DrawCorners(canvas, seen.checker->corners_px);
    const bool has_marked_corners = !boards.empty() && boards[seen.index].checker &&
                                    boards[seen.index].checker->holds_tags &&
                                    !seen.is_checker_missing;
    if (has_marked_corners) DrawCorners(canvas, seen.printed.front().pixels);
    if (camera) DrawBoard(canvas, *camera, seen);
  }
  return canvas;
}

}  // namespace sextant
