// SPDX-License-Identifier: Apache-2.0
#include "report/scan_picture.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "io/clouds/cloud_file.h"
#include "io/images/image_codec.h"
#include "io/output/output_file.h"

namespace sextant {
namespace {

constexpr int kWidth_px = 1400;
constexpr int kMinHeight_px = 300;
constexpr int kMaxHeight_px = 1400;
constexpr int kLegend_px = 44;
constexpr double kMargin_rad = 6.0 * std::numbers::pi / 180.0;
const cv::Scalar kOutline = {255, 255, 255};
const cv::Scalar kCorner = {80, 80, 255};

// Azimuth to the right, as seen from the sensor, and elevation up.
class Panorama {
 public:
  Panorama(const Eigen::Vector2d& low, const Eigen::Vector2d& high) : low_(low), high_(high) {
    const Eigen::Vector2d extent = high - low;
    scale_ = kWidth_px / extent.x();
    const int height =
        std::clamp(static_cast<int>(scale_ * extent.y()), kMinHeight_px, kMaxHeight_px);
    canvas_ = cv::Mat(height + kLegend_px, kWidth_px, CV_8UC3, cv::Scalar(24, 20, 20));
  }

  static Eigen::Vector2d AnglesOf(const Eigen::Vector3d& point) {
    return {-std::atan2(point.y(), point.x()), std::atan2(point.z(), point.head<2>().norm())};
  }

  cv::Point2d At(const Eigen::Vector3d& point) const {
    const Eigen::Vector2d angles = AnglesOf(point);
    return {scale_ * (angles.x() - low_.x()), kLegend_px + scale_ * (high_.y() - angles.y())};
  }

  bool Shows(const Eigen::Vector3d& point) const {
    const Eigen::Vector2d angles = AnglesOf(point);
    return (angles.array() > low_.array()).all() && (angles.array() < high_.array()).all();
  }

  cv::Mat& canvas() { return canvas_; }

 private:
  Eigen::Vector2d low_;
  Eigen::Vector2d high_;
  double scale_ = 1.0;
  cv::Mat canvas_;
};

// The part to draw: the boards with a margin, or the whole scan if no board was found.
Panorama FrameOf(const ScanReport& report, const PointCloud& cloud) {
  std::vector<Eigen::Vector3d> points;
  for (const Expected<LidarCorners>& corners : report.corners) {
    if (corners) points.insert(points.end(), corners->in_lidar.begin(), corners->in_lidar.end());
  }
  if (points.empty()) points = cloud.points;
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9);
  Eigen::Vector2d high = -low;
  for (const Eigen::Vector3d& point : points) {
    if (!point.allFinite() || point.squaredNorm() < 1e-4) continue;
    low = low.cwiseMin(Panorama::AnglesOf(point));
    high = high.cwiseMax(Panorama::AnglesOf(point));
  }
  return {low.array() - kMargin_rad, high.array() + kMargin_rad};
}

void DrawReturns(const PointCloud& cloud, Panorama& panorama) {
  std::vector<const Eigen::Vector3d*> shown;
  double nearest = 1e9;
  double farthest = 0.0;
  for (const Eigen::Vector3d& point : cloud.points) {
    if (!point.allFinite() || point.squaredNorm() < 1e-4 || !panorama.Shows(point)) continue;
    shown.push_back(&point);
    nearest = std::min(nearest, point.norm());
    farthest = std::max(farthest, point.norm());
  }
  cv::Mat levels(1, static_cast<int>(std::max<std::size_t>(1, shown.size())), CV_8U);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const double share = (shown[i]->norm() - nearest) / std::max(1e-9, farthest - nearest);
    levels.at<std::uint8_t>(static_cast<int>(i)) =
        cv::saturate_cast<std::uint8_t>(40.0 + 200.0 * share);
  }
  cv::Mat colors;
  cv::applyColorMap(levels, colors, cv::COLORMAP_TURBO);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const cv::Vec3b color = colors.at<cv::Vec3b>(static_cast<int>(i));
    cv::circle(panorama.canvas(), panorama.At(*shown[i]), 2,
               cv::Scalar(color[0], color[1], color[2]), cv::FILLED, cv::LINE_AA);
  }
}

void DrawBoard(const LidarCorners& corners, const Board& board, Panorama& panorama) {
  for (std::size_t i = 0; i < corners.in_lidar.size(); ++i) {
    const std::size_t next = i / 4 * 4 + (i + 1) % 4;
    cv::line(panorama.canvas(), panorama.At(corners.in_lidar[i]),
             panorama.At(corners.in_lidar[next]), kOutline, 2, cv::LINE_AA);
  }
  for (std::size_t i = 0; i < corners.in_lidar.size(); ++i) {
    const cv::Point2d at = panorama.At(corners.in_lidar[i]);
    cv::circle(panorama.canvas(), at, 6, kCorner, 2, cv::LINE_AA);
    cv::putText(panorama.canvas(), std::to_string(i), at + cv::Point2d(9, 5),
                cv::FONT_HERSHEY_SIMPLEX, 0.55, kCorner, 1, cv::LINE_AA);
  }
  const std::string name = board.name.empty() ? fmt::format("board {}", board.id) : board.name;
  cv::putText(panorama.canvas(), name, panorama.At(corners.in_lidar[0]) + cv::Point2d(-30, -14),
              cv::FONT_HERSHEY_SIMPLEX, 0.6, kOutline, 1, cv::LINE_AA);
}

}  // namespace

Expected<void> DrawScan(const std::string& scan, const ScanReport& report,
                        const std::vector<Board>& boards, const std::filesystem::path& out) {
  SEXTANT_ASSIGN_OR_RETURN(const PointCloud cloud, ReadCloud(scan));
  Panorama panorama = FrameOf(report, cloud);
  DrawReturns(cloud, panorama);
  for (const Expected<LidarCorners>& corners : report.corners) {
    if (corners) DrawBoard(*corners, boards[static_cast<std::size_t>(corners->board)], panorama);
  }
  cv::putText(panorama.canvas(),
              fmt::format("{}: as seen from the LiDAR, near blue to far red", scan), {12, 28},
              cv::FONT_HERSHEY_SIMPLEX, 0.6, {255, 255, 255}, 1, cv::LINE_AA);
  SEXTANT_ASSIGN_OR_RETURN(const std::string bytes,
                           EncodeImage(out.extension().string(), panorama.canvas()));
  return WriteFileAtomically(out, bytes);
}

}  // namespace sextant
