// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "features/lidar/corner_geometry.h"
#include "geometry/symmetric.h"

namespace sextant {
namespace {

constexpr double kThreshold_m = 0.01;  // As in the paper.
constexpr double kMinCosine = 0.2;     // Between ring and side's normal; bounds the variance.

struct Line3d {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();

  double Distance(const Eigen::Vector3d& p) const { return direction.cross(p - point).norm(); }
};

struct Junction {
  Eigen::Vector3d middle;
  double gap_m;
};

// The shortest segment between two lines; none if they are parallel.
std::optional<Junction> Join(const Line3d& a, const Line3d& b) {
  const Eigen::Vector3d across = a.direction.cross(b.direction);
  const double sine2 = across.squaredNorm();
  if (sine2 < 0.01) return std::nullopt;
  const Eigen::Vector3d between = b.point - a.point;
  const Eigen::Vector3d on_a =
      a.point + a.direction * (between.cross(b.direction).dot(across) / sine2);
  const Eigen::Vector3d on_b =
      b.point + b.direction * (between.cross(a.direction).dot(across) / sine2);
  return Junction{0.5 * (on_a + on_b), (on_b - on_a).norm()};
}

Line3d LeastSquaresLine(const std::vector<Eigen::Vector3d>& points) {
  Line3d line;
  for (const Eigen::Vector3d& p : points) line.point += p;
  line.point /= static_cast<double>(points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) {
    scatter += (p - line.point) * (p - line.point).transpose();
  }
  line.direction = EigenOf(scatter).vectors.col(2);
  return line;
}

// The inliers of the best line through two of the points. A side has few points, so all pairs are
// tried instead of random ones. Without refitting, only the two points themselves are returned.
std::vector<int> Consensus(const BoardPatch& patch, const std::vector<int>& members, bool refit) {
  const auto at = [&](int i) -> const Eigen::Vector3d& {
    return patch.edges[static_cast<std::size_t>(i)].last_return;
  };
  std::vector<int> best;
  std::vector<int> pair;
  double least = 0.0;
  for (std::size_t i = 0; i < members.size(); ++i) {
    for (std::size_t j = i + 1; j < members.size(); ++j) {
      const Eigen::Vector3d along = at(members[j]) - at(members[i]);
      if (along.norm() < kThreshold_m) continue;
      const Line3d line{at(members[i]), along.normalized()};
      std::vector<int> inliers;
      double sum = 0.0;
      for (const int k : members) {
        const double distance = line.Distance(at(k));
        if (distance > kThreshold_m) continue;
        inliers.push_back(k);
        sum += distance;
      }
      if (inliers.size() > best.size() || (inliers.size() == best.size() && sum < least)) {
        best = std::move(inliers);
        pair = {members[i], members[j]};
        least = sum;
      }
    }
  }
  return refit ? best : pair;
}

// Computes all corners from all points, and their derivatives by finite differences.
class LineCorners {
 public:
  LineCorners(const BoardPatch& patch, std::vector<std::vector<int>> members)
      : members_(std::move(members)) {
    for (const std::vector<int>& side : members_) {
      points_.emplace_back();
      for (const int i : side) {
        points_.back().push_back(patch.edges[static_cast<std::size_t>(i)].last_return);
      }
      lines_.push_back(LeastSquaresLine(points_.back()));
    }
  }

  std::optional<Junction> Corner(int corner) const {
    return Join(lines_[static_cast<std::size_t>(SideBefore(corner))],
                lines_[static_cast<std::size_t>(SideAfter(corner))]);
  }

  // Derivative of every corner by a displacement of one point of a side along `direction`.
  Eigen::VectorXd MovedBy(std::size_t side, std::size_t member, const Eigen::Vector3d& direction) {
    constexpr double kStep_m = 1e-6;
    Eigen::Vector3d& point = points_[side][member];
    const Eigen::Vector3d kept_point = point;
    const Line3d kept = lines_[side];
    const auto count = static_cast<int>(lines_.size());
    Eigen::VectorXd moved = Eigen::VectorXd::Zero(3 * count);
    for (const double sign : {1.0, -1.0}) {
      point = kept_point + sign * kStep_m * direction;
      lines_[side] = LeastSquaresLine(points_[side]);
      // The sign of a direction is arbitrary and does not move a corner.
      for (int corner = 0; corner < count; ++corner) {
        if (SideBefore(corner) != static_cast<int>(side) &&
            SideAfter(corner) != static_cast<int>(side)) {
          continue;
        }
        if (const std::optional<Junction> junction = Corner(corner)) {
          moved.segment<3>(3 * corner) += sign * junction->middle / (2.0 * kStep_m);
        }
      }
    }
    point = kept_point;
    lines_[side] = kept;
    return moved;
  }

  const std::vector<std::vector<int>>& members() const { return members_; }

 private:
  std::vector<std::vector<int>> members_;
  std::vector<std::vector<Eigen::Vector3d>> points_;
  std::vector<Line3d> lines_;
};

// Normals of the sides in the plane, pointing away from the board's material.
std::vector<Eigen::Vector2d> NormalsOf(const BoardPatch& patch, std::size_t sides) {
  std::vector<Eigen::Vector2d> normals;
  for (std::size_t side = 0; side < sides; ++side) {
    const double quarter = 0.5 * std::numbers::pi * static_cast<double>(side % kCornersPerBoard);
    const double angle = patch.fit.angle_rad + quarter;
    const double sign = side < kCornersPerBoard ? 1.0 : -1.0;
    normals.emplace_back(sign * std::sin(angle), -sign * std::cos(angle));
  }
  return normals;
}

// Each last return has range noise along its ray and an error along its ring uniform over a step.
// It also lies inside the board by half a step minus the growth by the beam, an error common to all
// points. The paper does not correct this bias, so it is included in the covariance.
Eigen::MatrixXd CovarianceOf(LineCorners& corners, const BoardPatch& patch) {
  const std::size_t sides = corners.members().size();
  const auto rows = static_cast<Eigen::Index>(3 * sides);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(rows, rows);
  Eigen::VectorXd shared = Eigen::VectorXd::Zero(rows);
  Eigen::VectorXd by_growth = Eigen::VectorXd::Zero(rows);
  const std::vector<Eigen::Vector2d> normals = NormalsOf(patch, sides);
  for (std::size_t side = 0; side < sides; ++side) {
    for (std::size_t k = 0; k < corners.members()[side].size(); ++k) {
      const EdgePoint& edge = patch.edges[static_cast<std::size_t>(corners.members()[side][k])];
      const Eigen::Vector3d ray = edge.last_return.normalized();
      const Eigen::Vector3d along =
          patch.plane.x_axis * edge.outward.x() + patch.plane.y_axis * edge.outward.y();
      const double range_sigma = patch.plane.sigma_m / std::abs(patch.plane.normal.dot(ray));
      const Eigen::VectorXd by_range = corners.MovedBy(side, k, ray) * range_sigma;
      const Eigen::VectorXd by_place = corners.MovedBy(side, k, along);
      const double cosine = std::max(kMinCosine, normals[side].dot(edge.outward));
      const double spot = edge.SpotAcross(normals[side]) / cosine;
      const double variance =
          edge.step_m * edge.step_m / 12.0 + std::pow(edge.beam.edge_sigma * spot, 2);
      covariance += by_range * by_range.transpose() + variance * by_place * by_place.transpose();
      shared += by_place * (edge.beam.growth * spot - 0.5 * edge.step_m);
      by_growth += by_place * edge.beam.growth_sigma * spot;
    }
  }
  return covariance + shared * shared.transpose() + by_growth * by_growth.transpose();
}

}  // namespace

Expected<LidarCorners> CornersByLines3d(const BoardPatch& patch, const Board& board, bool refit) {
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<std::vector<int>> groups, GroupBySide(patch, board));
  std::vector<std::vector<int>> inliers;
  for (std::size_t side = 0; side < groups.size(); ++side) {
    inliers.push_back(Consensus(patch, groups[side], refit));
    if (inliers.back().size() < 2) {
      return MakeError(ErrorCode::kTooFewPairs,
                       fmt::format("board {}: no two returns of side {} are {} m apart", board.id,
                                   side, kThreshold_m));
    }
  }
  LineCorners lines(patch, std::move(inliers));
  LidarCorners corners;
  corners.board = patch.board;
  std::vector<double> gaps;
  for (int i = 0; i < SidesOf(board); ++i) {
    const std::optional<Junction> junction = lines.Corner(i);
    if (!junction) {
      return MakeError(
          ErrorCode::kDegenerate,
          fmt::format("board {}: the edges that meet at corner {} are parallel", board.id, i));
    }
    corners.in_lidar.push_back(junction->middle);
    gaps.push_back(junction->gap_m);
  }
  corners.covariance = CovarianceOf(lines, patch);
  corners.checks = ChecksOf(patch, board, corners.in_lidar);
  corners.checks.line_gaps_m = std::move(gaps);
  return corners;
}

}  // namespace sextant
