// SPDX-License-Identifier: Apache-2.0
#include "calibrate/advise/predict_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/units.h"
#include "features/lidar/board_finder.h"
#include "geometry/board_check.h"

namespace sextant {
namespace {

constexpr double kSteepest_deg = 65.0;
constexpr double kSmallestPrint_px = 20.0;
constexpr double kSpotSigma = 0.18;
constexpr int kMinRaysPerSide = 2;

std::vector<std::vector<Eigen::Vector2d>> PrintsOf(const Board& board) {
  std::vector<std::vector<Eigen::Vector2d>> prints;
  for (const BoardTag& tag : board.tags) {
    const auto corners = TagCorners(tag);
    prints.emplace_back(corners.begin(), corners.end());
  }
  if (board.checker) {
    const BoardChecker& checker = *board.checker;
    auto& points = prints.emplace_back();
    for (int row = 0; row < checker.inner_rows; ++row) {
      for (int column = 0; column < checker.inner_columns; ++column) {
        points.push_back(checker.center_in_board_m +
                         checker.square_m *
                             Eigen::Vector2d(column - 0.5 * (checker.inner_columns - 1),
                                             row - 0.5 * (checker.inner_rows - 1)));
      }
    }
  }
  return prints;
}

std::optional<BoardPoints> SeePrint(const SensorPair& sensors,
                                    const std::vector<Eigen::Vector2d>& print,
                                    const Rigid3d& cam_from_board) {
  // Detectors need some margin around a print.
  constexpr double kMargin_px = 10.0;
  const Camera& camera = sensors.camera;
  BoardPoints points;
  Eigen::AlignedBox2d extent;
  for (const Eigen::Vector2d& at : print) {
    const auto pixel = Project(camera, cam_from_board * Eigen::Vector3d(at.x(), at.y(), 0.0));
    if (!pixel || (pixel->array() < kMargin_px).any() ||
        pixel->x() > camera.width_px - 1 - kMargin_px ||
        pixel->y() > camera.height_px - 1 - kMargin_px) {
      return std::nullopt;
    }
    extent.extend(*pixel);
    points.in_board_m.push_back(at);
    points.pixels.push_back(*pixel);
  }
  if (extent.isEmpty() || extent.sizes().minCoeff() < kSmallestPrint_px) return std::nullopt;
  const auto size = static_cast<Eigen::Index>(2 * print.size());
  points.covariance_px2 =
      std::pow(sensors.pixel_sigma_px, 2) * Eigen::MatrixXd::Identity(size, size);
  return points;
}

bool SeesFront(const Eigen::Vector3d& center, const Eigen::Vector3d& normal) {
  return center.normalized().dot(normal) > std::cos(kSteepest_deg * kRadPerDeg);
}

// Intersects the rings of a LiDAR with a board.
class RingCrossings {
 public:
  RingCrossings(const LidarPattern& lidar, const Board& board, const Rigid3d& lidar_from_board)
      : lidar_(lidar),
        half_(0.5 * board.top_right_m, 0.5 * board.right_bottom_m),
        board_from_lidar_(lidar_from_board.Inverse()),
        center_(lidar_from_board.translation) {}

  // Adds returns and edges to the view; false where too little of the board would be seen.
  bool AddTo(BoardView& view) const {
    const double middle = std::atan2(center_.y(), center_.x());
    const double reach =
        std::asin(std::min(1.0, half_.norm() / std::max(1e-3, center_.head<2>().norm()))) +
        2.0 * lidar_.azimuth_step_rad;
    int rings = 0;
    for (const double elevation : lidar_.elevations_rad) {
      const std::size_t before = view.face_in_lidar.size();
      AddRing(elevation, middle - reach, middle + reach, view);
      rings += view.face_in_lidar.size() > before ? 1 : 0;
    }
    std::array<int, kCornersPerBoard> rays{};
    for (const EdgeRay& ray : view.edges) ++rays[static_cast<std::size_t>(ray.side)];
    return rings >= kMinRings && *std::min_element(rays.begin(), rays.end()) >= kMinRaysPerSide;
  }

 private:
  static Eigen::Vector3d Direction(double elevation, double azimuth) {
    return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
            std::sin(elevation)};
  }

  // Intersection of a ray with the board's plane, in board axes [m]; none behind the LiDAR.
  std::optional<Eigen::Vector2d> Meet(double elevation, double azimuth) const {
    const Eigen::Vector3d direction = board_from_lidar_.rotation * Direction(elevation, azimuth);
    const Eigen::Vector3d& origin = board_from_lidar_.translation;
    const double range = -origin.z() / direction.z();
    if (!(range > 0.0) || !std::isfinite(range)) return std::nullopt;
    return (origin + range * direction).head<2>();
  }

  bool IsOn(double elevation, double azimuth) const {
    const auto at = Meet(elevation, azimuth);
    return at && std::abs(at->x()) < half_.x() && std::abs(at->y()) < half_.y();
  }

  void AddRing(double elevation, double from, double to, BoardView& view) const {
    const double step = lidar_.azimuth_step_rad;
    bool was_on = false;
    for (int i = 0; from + i * step <= to; ++i) {
      const double azimuth = from + i * step;
      const bool is_on = IsOn(elevation, azimuth);
      if (is_on) view.face_in_lidar.push_back(PointAt(elevation, azimuth));
      if (is_on != was_on) AddEdge(elevation, azimuth - step, azimuth, view);
      was_on = is_on;
    }
  }

  Eigen::Vector3d PointAt(double elevation, double azimuth) const {
    const Eigen::Vector2d at = *Meet(elevation, azimuth);
    return board_from_lidar_.Inverse() * Eigen::Vector3d(at.x(), at.y(), 0.0);
  }

  // Adds the edge between two azimuths of which exactly one hits the board, by bisection.
  void AddEdge(double elevation, double from, double to, BoardView& view) const {
    constexpr int kHalvings = 40;
    double on = IsOn(elevation, from) ? from : to;
    double off = on == from ? to : from;
    const auto away = Meet(elevation, off);
    const Eigen::Vector2d last = *Meet(elevation, on);
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (on + off);
      (IsOn(elevation, middle) ? on : off) = middle;
    }
    const Eigen::Vector2d share = Meet(elevation, on)->cwiseQuotient(half_);
    const bool on_x = std::abs(share.x()) > std::abs(share.y());
    const int axis = on_x ? 0 : 1;
    const double range = PointAt(elevation, on).norm();
    const double step_m = away ? std::abs((*away - last)[axis]) : half_[axis];
    const double spot_m = lidar_.aperture_m + lidar_.divergence_rad * range;
    EdgeRay ray;
    ray.direction = Direction(elevation, on);
    ray.side = on_x ? (share.x() > 0.0 ? 1 : 3) : (share.y() > 0.0 ? 2 : 0);
    ray.sigma_m = std::hypot(step_m / std::sqrt(12.0), kSpotSigma * spot_m);
    view.edges.push_back(ray);
  }

  const LidarPattern& lidar_;
  Eigen::Vector2d half_;
  Rigid3d board_from_lidar_;
  Eigen::Vector3d center_;
};

}  // namespace

std::optional<BoardView> PredictView(const SensorPair& sensors, const Board& board,
                                     const Rigid3d& cam_from_board) {
  const Rigid3d lidar_from_board = sensors.cam_from_lidar.Inverse() * cam_from_board;
  const auto normal_of = [](const Rigid3d& pose) {
    return (pose.rotation * Eigen::Vector3d::UnitZ()).eval();
  };
  if (!SeesFront(cam_from_board.translation, normal_of(cam_from_board)) ||
      !SeesFront(lidar_from_board.translation, normal_of(lidar_from_board))) {
    return std::nullopt;
  }
  BoardView view;
  view.board = board.id;
  view.range_sigma_m = sensors.lidar.range_sigma_m;
  view.cam_from_board = cam_from_board;
  view.lidar_from_board = lidar_from_board;
  for (const std::vector<Eigen::Vector2d>& print : PrintsOf(board)) {
    std::optional<BoardPoints> points = SeePrint(sensors, print, cam_from_board);
    if (!points) return std::nullopt;
    view.printed.push_back(std::move(*points));
  }
  if (view.printed.empty()) return std::nullopt;
  if (!RingCrossings(sensors.lidar, board, lidar_from_board).AddTo(view)) return std::nullopt;
  return view;
}

}  // namespace sextant
