// SPDX-License-Identifier: Apache-2.0
#include "simulator/session/contact_sheet.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "simulator/camera/render.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/lidar/scan.h"
#include "simulator/scene/scene_truth.h"
#include "simulator/session/validate_scene.h"

namespace sextant {
namespace {

constexpr int kRows = 480;
constexpr int kColumns = 640;
const cv::Scalar kBackground(24, 20, 18);

// Perspective view of the boards from the LiDAR along its x axis.
class FrontView {
 public:
  explicit FrontView(const std::vector<BoardTruth>& boards) {
    Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9);
    Eigen::Vector2d high = -low;
    for (const BoardTruth& board : boards) {
      for (const CornerTruth& corner : board.corners) {
        if (corner.in_lidar.x() <= 0.0) continue;
        low = low.cwiseMin(Slopes(corner.in_lidar));
        high = high.cwiseMax(Slopes(corner.in_lidar));
        farthest_m_ = std::max(farthest_m_, corner.in_lidar.norm());
      }
    }
    center_ = 0.5 * (low + high);
    const Eigen::Vector2d size = (1.25 * (high - low)).cwiseMax(0.05);
    scale_ = std::min(kColumns / size.x(), kRows / size.y());
  }

  cv::Point2d Place(const Eigen::Vector3d& in_lidar) const {
    const Eigen::Vector2d at = scale_ * (Slopes(in_lidar) - center_);
    return {0.5 * kColumns + at.x(), 0.5 * kRows + at.y()};
  }
  static bool IsAhead(const Eigen::Vector3d& in_lidar) {
    return in_lidar.x() > 0.1 && in_lidar.allFinite();
  }
  double farthest_m() const { return farthest_m_; }

 private:
  // Offsets to the right and down per metre of distance.
  static Eigen::Vector2d Slopes(const Eigen::Vector3d& p) {
    return {-p.y() / p.x(), -p.z() / p.x()};
  }

  Eigen::Vector2d center_;
  double scale_ = 1.0;
  double farthest_m_ = 0.0;
};

cv::Mat EmptyPanel() { return {kRows, kColumns, CV_8UC3, kBackground}; }

void Caption(cv::Mat& panel, const std::string& text) {
  cv::rectangle(panel, {0, kRows - 26}, {panel.cols, kRows}, cv::Scalar(0, 0, 0), cv::FILLED);
  cv::putText(panel, text, {8, kRows - 8}, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar(255, 255, 255),
              1, cv::LINE_AA);
}

void Dot(cv::Mat& panel, const cv::Point2d& at, int radius, const cv::Scalar& color) {
  constexpr int kShift = 4;
  const cv::Point2d scaled = at * (1 << kShift);
  if (at.x < -9.0 || at.y < -9.0 || at.x > kColumns + 9.0 || at.y > kRows + 9.0) return;
  cv::circle(panel, {cvRound(scaled.x), cvRound(scaled.y)}, radius << kShift, color, cv::FILLED,
             cv::LINE_AA, kShift);
}

// Red for near and blue for far points, as in common point cloud viewers.
std::vector<cv::Scalar> ColorsByRange(const PointCloud& cloud, double near_m, double far_m) {
  cv::Mat levels(1, static_cast<int>(cloud.points.size()), CV_8U);
  for (int i = 0; i < levels.cols; ++i) {
    const double range = cloud.points[static_cast<std::size_t>(i)].norm();
    const double share = std::clamp((far_m - range) / (far_m - near_m), 0.0, 1.0);
    levels.at<std::uint8_t>(0, i) = cv::saturate_cast<std::uint8_t>(255.0 * share);
  }
  cv::Mat bgr;
  cv::applyColorMap(levels, bgr, cv::COLORMAP_JET);
  std::vector<cv::Scalar> colors;
  for (int i = 0; i < bgr.cols; ++i) {
    const cv::Vec3b c = bgr.at<cv::Vec3b>(0, i);
    colors.emplace_back(c[0], c[1], c[2]);
  }
  return colors;
}

cv::Mat DrawScan(const FrontView& view, const PointCloud& cloud) {
  cv::Mat panel = EmptyPanel();
  if (cloud.points.empty()) return panel;
  const std::vector<cv::Scalar> colors =
      ColorsByRange(cloud, 0.6 * view.farthest_m(), 2.2 * view.farthest_m());
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (FrontView::IsAhead(cloud.points[i])) {
      Dot(panel, view.Place(cloud.points[i]), 2, colors[i]);
    }
  }
  return panel;
}

// Points next to a jump to a larger range along each ring.
std::vector<Eigen::Vector3d> EdgePoints(const PointCloud& cloud) {
  constexpr double kJump_m = 0.3;
  std::map<int, std::map<double, Eigen::Vector3d>> rings;
  for (std::size_t i = 0; i < cloud.ring.size(); ++i) {
    const Eigen::Vector3d& p = cloud.points[i];
    if (p.allFinite()) rings[cloud.ring[i]].emplace(std::atan2(p.y(), p.x()), p);
  }
  std::vector<Eigen::Vector3d> edges;
  for (const auto& [ring, by_azimuth] : rings) {
    const Eigen::Vector3d* before = nullptr;
    for (const auto& [azimuth, point] : by_azimuth) {
      if (before != nullptr && std::abs(point.norm() - before->norm()) > kJump_m) {
        edges.push_back(point.norm() < before->norm() ? point : *before);
      }
      before = &point;
    }
  }
  return edges;
}

void DrawOutline(cv::Mat& panel, const FrontView& view, const std::vector<CornerTruth>& corners,
                 std::size_t first) {
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d& a = corners[first + i].in_lidar;
    const Eigen::Vector3d& b = corners[first + (i + 1) % 4].in_lidar;
    if (!FrontView::IsAhead(a) || !FrontView::IsAhead(b)) continue;
    cv::line(panel, view.Place(a), view.Place(b), cv::Scalar(110, 110, 110), 1, cv::LINE_AA);
  }
}

cv::Mat DrawEdges(const FrontView& view, const PointCloud& cloud,
                  const std::vector<BoardTruth>& boards) {
  cv::Mat panel = EmptyPanel();
  for (const BoardTruth& board : boards) {
    for (std::size_t first = 0; first < board.corners.size(); first += 4) {
      DrawOutline(panel, view, board.corners, first);
    }
  }
  for (const Eigen::Vector3d& point : EdgePoints(cloud)) {
    const bool is_near = point.norm() < view.farthest_m() + 0.2;
    if (is_near && FrontView::IsAhead(point)) {
      Dot(panel, view.Place(point), 3, cv::Scalar(80, 200, 255));
    }
  }
  return panel;
}

cv::Mat ImagePanel(const cv::Mat& image) {
  cv::Mat color;
  cv::cvtColor(image, color, cv::COLOR_GRAY2BGR);
  cv::Mat panel;
  const double scale = static_cast<double>(kRows) / image.rows;
  cv::resize(color, panel, {cvRound(scale * image.cols), kRows}, 0.0, 0.0, cv::INTER_AREA);
  return panel;
}

}  // namespace

Expected<cv::Mat> DrawContactSheet(const Scene& scene, std::uint64_t seed) {
  SEXTANT_RETURN_IF_ERROR(ValidateScene(scene));
  SEXTANT_ASSIGN_OR_RETURN(const LidarModel model, FindLidarModel(scene.lidar.model));
  SEXTANT_ASSIGN_OR_RETURN(const SimulatedScan scan, SimulateScan(scene, model, {.seed = seed}));
  const double middle_s = 0.5 * model.turn_period_s;
  SEXTANT_ASSIGN_OR_RETURN(const cv::Mat image,
                           RenderImage(scene, 0, UsualImageOptions(seed, middle_s)));
  const std::vector<BoardTruth> boards = BoardsAt(scene, middle_s);
  const FrontView view(boards);
  std::vector<cv::Mat> panels = {ImagePanel(image), DrawScan(view, scan.cloud),
                                 DrawEdges(view, scan.cloud, boards)};
  Caption(panels[0], "image of " + scene.cameras[0].name);
  Caption(panels[1], "scan of " + model.name + ", seen from it; colour: range");
  Caption(panels[2], "points at jumps in range; grey: true outlines");
  cv::Mat sheet;
  cv::hconcat(panels, sheet);
  return sheet;
}

}  // namespace sextant
