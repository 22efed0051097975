// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/closing.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/units.h"
#include "geometry/symmetric.h"

namespace sextant {
namespace {

constexpr int kEnoughViews = 8;
constexpr double kMinNormalSpread_rad = 15.0 / kDegPerRad;
constexpr double kMinRangeRatio =
    1.3;  // Smallest useful ratio of the farthest range to the nearest.

// How the boards are spread over orientations and ranges, which determines the uncertainty.
struct Spread {
  double normals_rad = 0.0;  ///< Largest angle between two boards' normals.
  double nearest_m = 0.0;
  double farthest_m = 0.0;
};

Spread SpreadOf(const std::vector<BoardView>& views) {
  Spread spread{.normals_rad = 0.0, .nearest_m = 1e9, .farthest_m = 0.0};
  for (const BoardView& a : views) {
    const double range = a.cam_from_board.translation.norm();
    spread.nearest_m = std::min(spread.nearest_m, range);
    spread.farthest_m = std::max(spread.farthest_m, range);
    const Eigen::Vector3d normal = a.lidar_from_board.rotation * Eigen::Vector3d::UnitZ();
    for (const BoardView& b : views) {
      const double along = normal.dot(b.lidar_from_board.rotation * Eigen::Vector3d::UnitZ());
      spread.normals_rad = std::max(spread.normals_rad, std::acos(std::clamp(along, -1.0, 1.0)));
    }
  }
  return spread;
}

std::string AxisText(const Eigen::Vector3d& axis) {
  return fmt::format("({:.2f}, {:.2f}, {:.2f})", axis.x(), axis.y(), axis.z());
}

std::string AmbiguityText(const Matching& matching) {
  if (matching.alternatives.empty()) return {};
  return fmt::format(
      "It is one of {} poses that explain the views equally well, and was chosen by "
      "the assumed mounting of the sensors. ",
      matching.alternatives.size() + 1);
}

std::string UncertaintyText(const SolveReport& report) {
  if (!report.covariance) {
    return "Its uncertainty is unavailable: the data is not redundant.";
  }
  const Matrix6d& covariance = *report.covariance;
  const SymmetricEigen<3> turn = EigenOf<3>(covariance.topLeftCorner<3, 3>());
  const SymmetricEigen<3> shift = EigenOf<3>(covariance.bottomRightCorner<3, 3>());
  return fmt::format(
      "One standard deviation is {:.2f} deg and {:.1f} mm over all axes together; weakest are the "
      "rotation about {} with {:.2f} deg and the translation along {} with {:.1f} mm, in the "
      "camera frame.",
      kDegPerRad * std::sqrt(turn.values.sum()), 1e3 * std::sqrt(shift.values.sum()),
      AxisText(turn.vectors.col(2)), kDegPerRad * std::sqrt(turn.values(2)),
      AxisText(shift.vectors.col(2)), 1e3 * std::sqrt(shift.values(2)));
}

// What limits the accuracy and what to do about it, most effective first.
std::string ClosingAdvice(const Assembly& assembly, int views) {
  const Spread spread = SpreadOf(assembly.problem.board_views);
  std::string limits;
  std::string advice;
  const auto add = [](std::string& list, const std::string& item) {
    list += (list.empty() ? "" : "; ") + item;
  };
  if (views < kEnoughViews) {
    add(limits, fmt::format("{} view{}", views, views == 1 ? "" : "s"));
    add(advice, fmt::format("{} more view{} with the board elsewhere", kEnoughViews - views,
                            kEnoughViews - views == 1 ? "" : "s"));
  }
  const bool has_spread = assembly.problem.board_views.size() > 1;
  if (has_spread && spread.normals_rad < kMinNormalSpread_rad) {
    add(limits, fmt::format("all boards within {:.0f} deg of parallel",
                            std::ceil(kDegPerRad * spread.normals_rad)));
    add(advice, "tilt and turn the board by 30 deg or more, both ways");
  }
  if (has_spread && spread.farthest_m < kMinRangeRatio * spread.nearest_m) {
    add(limits, fmt::format("all boards between {:.1f} and {:.1f} m away", spread.nearest_m,
                            spread.farthest_m));
    add(advice, "hold it both nearer and farther");
  }
  if (limits.empty()) {
    return "The views are many and well spread: the sensors' noise and errors of their models "
           "limit it "
           "now; only more views help, with the square root of their number.";
  }
  return fmt::format("What limits it: {}. To improve it: {}.", limits, advice);
}

}  // namespace

std::string ClosingParagraph(const Assembly& assembly, const SolveReport& report) {
  std::set<int> views;
  for (const BoardView& board : assembly.problem.board_views) views.insert(board.view);
  std::set<std::size_t> all;
  for (const BoardRow& row : assembly.rows) all.insert(row.view);
  const std::size_t boards = assembly.problem.board_views.size();
  return fmt::format(
      "cam_from_lidar maps a point of the LiDAR frame (x forward, y left, z up) into the camera "
      "frame (x right, y down, z forward): point_in_cam = cam_from_lidar * point_in_lidar. It "
      "rests on {} board{} in {} of {} view{}. {}{} {}",
      boards, boards == 1 ? "" : "s", views.size(), all.size(), all.size() == 1 ? "" : "s",
      AmbiguityText(assembly.matching), UncertaintyText(report),
      ClosingAdvice(assembly, static_cast<int>(views.size())));
}

}  // namespace sextant
