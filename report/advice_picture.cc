// SPDX-License-Identifier: Apache-2.0
#include "report/advice_picture.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "geometry/board_check.h"
#include "solvers/core/board_view_check.h"

namespace sextant {
namespace {

constexpr int kHeight_px = 620;
constexpr int kTop_px = 620;  ///< Width of the view from above.
constexpr int kGap_px = 16;
const cv::Scalar kPaper(255, 255, 255);
const cv::Scalar kInk(60, 60, 60);
const cv::Scalar kFaint(220, 220, 220);
const cv::Scalar kSeen(170, 150, 130);
const cv::Scalar kNext(0, 120, 255);
const cv::Scalar kReturn(200, 60, 30);

struct PlacedBoard {
  const Board* board;
  Rigid3d cam_from_board;
};

std::vector<PlacedBoard> SeenBoardsOf(const CalibrationResult& result) {
  std::vector<PlacedBoard> placed;
  for (const ResultView& view : result.views) {
    if (!view.kept) continue;
    for (const ResultBoardView& seen : view.boards) {
      const Board* board = FindBoard(result.boards, seen.board);
      if (board == nullptr || !seen.cam_from_board) continue;
      placed.push_back({board, *seen.cam_from_board});
    }
  }
  return placed;
}

std::array<Eigen::Vector3d, 4> CornersOf(const PlacedBoard& placed) {
  const double x = 0.5 * placed.board->top_right_m;
  const double y = 0.5 * placed.board->right_bottom_m;
  return {placed.cam_from_board * Eigen::Vector3d(-x, -y, 0.0),
          placed.cam_from_board * Eigen::Vector3d(x, -y, 0.0),
          placed.cam_from_board * Eigen::Vector3d(x, y, 0.0),
          placed.cam_from_board * Eigen::Vector3d(-x, y, 0.0)};
}

void Write(cv::Mat& canvas, const std::string& text, const cv::Point& at, const cv::Scalar& colour,
           double scale = 0.5) {
  cv::putText(canvas, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, colour, 1, cv::LINE_AA);
}

/// The room from above: the camera at the bottom, looking up.
class TopView {
 public:
  TopView(cv::Mat canvas, double depth_m) : canvas_(std::move(canvas)) {
    scale_ = (canvas_.rows - 90.0) / depth_m;
    origin_ = {canvas_.cols / 2, canvas_.rows - 45};
    for (int metre = 1; metre < depth_m; ++metre) {
      cv::circle(canvas_, origin_, cvRound(scale_ * metre), kFaint, 1, cv::LINE_AA);
      Write(canvas_, fmt::format("{} m", metre), At({0.0, 0.0, static_cast<double>(metre)}), kSeen,
            0.4);
    }
  }

  void DrawSensors(const SensorPair& sensors, double depth_m) {
    const Camera& camera = sensors.camera;
    for (const double u : {0.0, camera.width_px - 1.0}) {
      const auto ray = Unproject(camera, {u, 0.5 * camera.height_px});
      if (ray && ray->z() > 0.0) {
        cv::line(canvas_, origin_, At(*ray * (depth_m / ray->z())), kSeen, 1, cv::LINE_AA);
      }
    }
    cv::circle(canvas_, origin_, 5, kInk, cv::FILLED, cv::LINE_AA);
    const cv::Point lidar = At(sensors.cam_from_lidar.translation);
    cv::circle(canvas_, lidar, 8, kReturn, 2, cv::LINE_AA);
    Write(canvas_, "camera", origin_ + cv::Point(-70, 22), kInk);
    Write(canvas_, "LiDAR", lidar + cv::Point(16, 20), kReturn);
  }

  void DrawBoard(const PlacedBoard& placed, const cv::Scalar& colour, const std::string& label) {
    std::vector<cv::Point> outline;
    for (const Eigen::Vector3d& corner : CornersOf(placed)) outline.push_back(At(corner));
    const bool next = !label.empty();
    cv::polylines(canvas_, outline, true, colour, next ? 4 : 2, cv::LINE_AA);
    if (next) Write(canvas_, label, outline[1] + cv::Point(10, 4), colour, 0.7);
  }

 private:
  cv::Point At(const Eigen::Vector3d& in_cam) const {
    return origin_ + cv::Point(cvRound(scale_ * in_cam.x()), -cvRound(scale_ * in_cam.z()));
  }

  cv::Mat canvas_;
  double scale_ = 1.0;
  cv::Point origin_;
};

/// The camera's image, drawn smaller.
class ImageView {
 public:
  ImageView(cv::Mat canvas, const Camera& camera)
      : canvas_(std::move(canvas)),
        camera_(camera),
        scale_(static_cast<double>(canvas_.cols) / camera.width_px) {
    cv::rectangle(canvas_, {0, 0, canvas_.cols, canvas_.rows}, kInk, 1);
  }

  void DrawOutline(const std::vector<Eigen::Vector3d>& corners, const cv::Scalar& colour,
                   int thickness) {
    constexpr int kPieces = 12;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Eigen::Vector3d along = corners[(k + 1) % corners.size()] - corners[k];
      std::optional<cv::Point> last = At(corners[k]);
      for (int i = 1; i <= kPieces; ++i) {
        const std::optional<cv::Point> next =
            At(corners[k] + static_cast<double>(i) / kPieces * along);
        if (last && next) cv::line(canvas_, *last, *next, colour, thickness, cv::LINE_AA);
        last = next;
      }
    }
  }

  void DrawBoard(const PlacedBoard& placed, const cv::Scalar& colour, int thickness) {
    const auto corners = CornersOf(placed);
    DrawOutline({corners.begin(), corners.end()}, colour, thickness);
    for (const BoardTag& tag : placed.board->tags) {
      std::vector<Eigen::Vector3d> print;
      for (const Eigen::Vector2d& at : TagCorners(tag)) {
        print.emplace_back(placed.cam_from_board * Eigen::Vector3d(at.x(), at.y(), 0.0));
      }
      DrawOutline(print, colour, 1);
    }
  }

  void DrawReturns(const std::vector<Eigen::Vector3d>& in_lidar, const Rigid3d& cam_from_lidar) {
    for (const Eigen::Vector3d& point : in_lidar) {
      if (const auto at = At(cam_from_lidar * point)) {
        cv::circle(canvas_, *at, 1, kReturn, cv::FILLED, cv::LINE_AA);
      }
    }
  }

  void Label(const Eigen::Vector3d& in_cam, const std::string& text) {
    if (const auto at = At(in_cam)) Write(canvas_, text, *at + cv::Point(-5, -10), kNext, 0.7);
  }

 private:
  std::optional<cv::Point> At(const Eigen::Vector3d& in_cam) const {
    const auto pixel = Project(camera_, in_cam);
    if (!pixel || pixel->cwiseAbs().maxCoeff() > 1e5) return std::nullopt;
    return cv::Point(cvRound(scale_ * pixel->x()), cvRound(scale_ * pixel->y()));
  }

  cv::Mat canvas_;
  Camera camera_;
  double scale_;
};

double DepthOf(const std::vector<PlacedBoard>& placed) {
  double depth = 2.0;
  for (const PlacedBoard& board : placed) {
    depth = std::max(depth, board.cam_from_board.translation.z() + 0.6);
  }
  return depth;
}

}  // namespace

cv::Mat DrawAdvice(const CalibrationResult& result, const SensorPair& sensors,
                   const std::vector<BoardProposal>& proposals) {
  const double aspect = static_cast<double>(sensors.camera.height_px) / sensors.camera.width_px;
  constexpr int kHead_px = 34;
  constexpr int kMaxWidth_px = 900;
  constexpr int kMaxHeight_px = kHeight_px - kHead_px;
  // Both are rounded, and a product of rounded numbers may be a pixel too high.
  const int image_width = std::clamp(cvRound(kMaxHeight_px / aspect), 1, kMaxWidth_px);
  const int image_height = std::clamp(cvRound(image_width * aspect), 1, kMaxHeight_px);
  cv::Mat canvas(kHeight_px, kTop_px + kGap_px + image_width + kGap_px, CV_8UC3, kPaper);
  const std::vector<PlacedBoard> seen = SeenBoardsOf(result);
  std::vector<PlacedBoard> next;
  for (const BoardProposal& proposal : proposals) {
    next.push_back({&result.boards[proposal.board], proposal.cam_from_board});
  }
  std::vector<PlacedBoard> all = seen;
  all.insert(all.end(), next.begin(), next.end());
  const double depth_m = DepthOf(all);
  TopView top(canvas(cv::Rect(0, 0, kTop_px, kHeight_px)), depth_m);
  top.DrawSensors(sensors, depth_m);
  ImageView image(canvas(cv::Rect(kTop_px + kGap_px, kHead_px, image_width, image_height)),
                  sensors.camera);
  for (const PlacedBoard& board : seen) {
    top.DrawBoard(board, kSeen, "");
    image.DrawBoard(board, kSeen, 1);
  }
  for (std::size_t i = 0; i < next.size(); ++i) {
    const std::string label = next.size() == 1 ? "next" : fmt::format("next {}", i + 1);
    top.DrawBoard(next[i], kNext, label);
    image.DrawBoard(next[i], kNext, 3);
    if (const auto view = PredictView(sensors, *next[i].board, next[i].cam_from_board)) {
      image.DrawReturns(view->face_in_lidar, sensors.cam_from_lidar);
    }
    image.Label(CornersOf(next[i])[0], label);
  }
  Write(canvas, "from above", {12, 22}, kInk, 0.6);
  Write(canvas, fmt::format("the camera's image; {} boards seen before in grey", seen.size()),
        {kTop_px + kGap_px, 22}, kInk, 0.6);
  return canvas;
}

}  // namespace sextant
