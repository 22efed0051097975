// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/board_agreement.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace sextant {
namespace {

constexpr double kBand_m = 0.08;  // Width of the band around the board in which its plane must end.
constexpr double kMinFilled = 0.9;
constexpr double kMaxContinued = 0.12;  // Hands and stands: up to 0.08; furniture: at least 0.16.
constexpr double kMinContained = 0.8;
constexpr double kMinVisible = 0.5;
constexpr double kMinShare = 0.6;
constexpr double kMaxRms = 2.8;  // In sigmas; a board of another size has more.
constexpr double kMinDensity = 0.3;
constexpr int kMinSides = 3;
constexpr int kMinEdgePoints = 8;
constexpr int kMinEdgePointsOnMinRings = 12;  // With kMinRings, furniture has up to 11 by chance.
constexpr int kMinPointsOfBoard = 16;

// Distance of a point beyond the rectangle's nearest side; negative inside.
double Beyond(const Eigen::Vector2d& point, double width, double height) {
  return std::max(std::abs(point.x()) - 0.5 * width, std::abs(point.y()) - 0.5 * height);
}

}  // namespace

double BeyondBoard(const BoardPatch& patch, const Board& board, const Eigen::Vector2d& in_plane) {
  const Eigen::Vector2d in_board =
      Eigen::Rotation2Dd(-patch.fit.angle_rad) * (in_plane - patch.fit.center);
  return Beyond(in_board, board.top_right_m, board.right_bottom_m);
}

BoardAgreement AgreementOf(const ScanRings& scan, const BoardPatch& patch, const Board& board) {
  BoardAgreement agreement;
  const LidarPlane& plane = patch.plane;
  const Eigen::Vector3d center = plane.At(patch.fit.center);
  const double reach = 0.5 * std::hypot(board.top_right_m, board.right_bottom_m) + 2.0 * kBand_m;
  const double cosine = std::cos(std::min(1.5, std::atan2(reach, center.norm()) * 1.1));
  const Eigen::Vector3d toward = center.normalized();
  const Eigen::Rotation2Dd turn(-patch.fit.angle_rad);
  const double near = 0.02 + 4.0 * plane.sigma_m;
  const double margin = 0.015 + scan.azimuth_step_rad() * center.norm();
  int hit = 0;
  int through = 0;
  int hidden = 0;
  int around = 0;
  int around_on_plane = 0;
  for (int ring = 0; ring < scan.rings(); ++ring) {
    bool any = false;
    for (const RingPoint& point : scan.ring(ring)) {
      if (point.point.dot(toward) < cosine * point.range_m) continue;
      const std::optional<Eigen::Vector2d> there = plane.Meet(point.point);
      if (!there) continue;
      const Eigen::Vector2d q = turn * (*there - patch.fit.center);
      const double beyond = Beyond(q, board.top_right_m, board.right_bottom_m);
      const double off = plane.normal.dot(point.point - plane.origin);
      const bool in_opening =
          board.hole && Beyond(q - board.hole->center_in_board_m, board.hole->width_m,
                               board.hole->height_m) < margin;
      if (beyond < -margin && !in_opening) {
        if (std::abs(off) <= near) {
          ++hit;
          any = true;
        } else {
          ++(off > 0.0 ? through : hidden);
        }
      } else if (beyond > margin && beyond < margin + kBand_m) {
        ++around;
        around_on_plane += std::abs(off) <= near ? 1 : 0;
      }
    }
    agreement.rings += any ? 1 : 0;
  }
  std::size_t inside = 0;
  for (const std::size_t place : patch.on_plane) {
    const std::optional<Eigen::Vector2d> there = plane.Meet(scan.points()[place].point);
    inside += there && BeyondBoard(patch, board, *there) < margin ? 1U : 0U;
  }
  agreement.contained = static_cast<double>(inside) /
                        static_cast<double>(std::max<std::size_t>(1, patch.on_plane.size()));
  double solid = board.top_right_m * board.right_bottom_m;
  if (board.hole) solid -= board.hole->width_m * board.hole->height_m;
  const double solid_angle = solid * std::abs(plane.normal.dot(toward)) / center.squaredNorm();
  agreement.density = static_cast<double>(inside) * scan.azimuth_step_rad() *
                      scan.elevation_step_rad() / solid_angle;
  agreement.points = hit;
  agreement.filled = hit > 0 ? static_cast<double>(hit) / (hit + through) : 0.0;
  agreement.visible = 1.0 - static_cast<double>(hidden) / std::max(1, hit + through + hidden);
  agreement.continued = around > 0 ? static_cast<double>(around_on_plane) / around : 0.0;
  return agreement;
}

std::optional<std::string> RejectionReason(const BoardPatch& patch, const Board& board) {
  const BoardAgreement& agreement = patch.agreement;
  if (agreement.rings < kMinRings) {
    return fmt::format(
        "only {} rings cross it, {} are needed: move it closer or use a sensor with more rings",
        agreement.rings, kMinRings);
  }
  const int min_edge_points =
      agreement.rings == kMinRings ? kMinEdgePointsOnMinRings : kMinEdgePoints;
  if (static_cast<int>(patch.edges.size()) < min_edge_points) {
    return fmt::format("only {} edge points on {} rings, {} are needed", patch.edges.size(),
                       agreement.rings, min_edge_points);
  }
  if (agreement.points < kMinPointsOfBoard) {
    return fmt::format("only {} returns on it, {} are needed", agreement.points, kMinPointsOfBoard);
  }
  if (agreement.density < kMinDensity) {
    return fmt::format("only {:.0f} % of the returns expected from a board there",
                       100.0 * agreement.density);
  }
  if (patch.fit.sides_seen < kMinSides) {
    return fmt::format("edges were found on {} of its sides, {} are needed", patch.fit.sides_seen,
                       kMinSides);
  }
  if (patch.fit.share < kMinShare || patch.fit.rms > kMaxRms) {
    return fmt::format(
        "its outline is not {:.3f} x {:.3f} m: {:.0f} % of the edge points fit, {:.1f} sigma rms",
        board.top_right_m, board.right_bottom_m, 100.0 * patch.fit.share, patch.fit.rms);
  }
  if (agreement.contained < kMinContained) {
    return fmt::format("{:.0f} % of its flat surface lies beyond a board of {:.3f} x {:.3f} m",
                       100.0 * (1.0 - agreement.contained), board.top_right_m,
                       board.right_bottom_m);
  }
  if (agreement.filled < kMinFilled) {
    return fmt::format("{:.0f} % of the rays pass through it", 100.0 * (1.0 - agreement.filled));
  }
  if (agreement.visible < kMinVisible) {
    return fmt::format("a nearer object hides {:.0f} % of it", 100.0 * (1.0 - agreement.visible));
  }
  if (agreement.continued > kMaxContinued) {
    return fmt::format(
        "its plane continues beyond it ({:.0f} % of the rays around it), as a wall's "
        "does",
        100.0 * agreement.continued);
  }
  return std::nullopt;
}

}  // namespace sextant
