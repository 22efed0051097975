// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <Eigen/LU>
#include <cmath>

#include "features/lidar/corner_geometry.h"
#include "geometry/symmetric.h"

namespace sextant {
namespace {

constexpr double kHuber_m = 0.005;
constexpr int kRounds = 5;

// normal . point = offset, with the covariance of (angle of the normal about `center`, offset).
struct PlaneLine {
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();
  double offset = 0.0;
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  double growth_sigma = 0.0;  // Error of the offset, common to all edges of the board.

  // Derivative of the line's position along its normal at a point by (angle, offset at the centre).
  Eigen::RowVector2d MovedAt(const Eigen::Vector2d& point) const {
    const Eigen::Vector2d along(-normal.y(), normal.x());
    return {-along.dot(point - center), 1.0};
  }
};

double SharedVariance(const std::vector<EdgePoint>& edges, const std::vector<int>& members,
                      const PlaneLine& line) {
  SharedStep shared;
  for (const int member : members) {
    const EdgePoint& edge = edges[static_cast<std::size_t>(member)];
    shared.Add(line.normal.dot(edge.in_plane) - line.offset,
               0.5 * std::abs(line.normal.dot(edge.outward)) * edge.step_m);
  }
  return shared.Variance();
}

// Moves the line by the growth due to the beam, to the true edge.
void SubtractGrowth(const std::vector<EdgePoint>& edges, const std::vector<int>& members,
                    const std::vector<double>& weights, PlaneLine& line) {
  double total = 0.0;
  double outward = 0.0;
  double growth = 0.0;
  double sigma = 0.0;
  for (std::size_t i = 0; i < members.size(); ++i) {
    const EdgePoint& edge = edges[static_cast<std::size_t>(members[i])];
    total += weights[i];
    outward += weights[i] * line.normal.dot(edge.outward);
    growth += weights[i] * edge.Growth(line.normal);
    sigma += weights[i] * edge.beam.growth_sigma * edge.SpotAcross(line.normal);
  }
  const double sign = outward < 0.0 ? -1.0 : 1.0;
  line.offset -= sign * growth / total;
  line.growth_sigma = sign * sigma / total;
}

// Total least squares with Huber's weights. The noise of a point is along its ring; only its
// component along the normal affects the line.
PlaneLine FitLine(const std::vector<EdgePoint>& edges, const std::vector<int>& members) {
  std::vector<double> weights(members.size(), 1.0);
  PlaneLine line;
  for (int round = 0; round < kRounds; ++round) {
    double total = 0.0;
    line.center.setZero();
    for (std::size_t i = 0; i < members.size(); ++i) {
      line.center += weights[i] * edges[static_cast<std::size_t>(members[i])].in_plane;
      total += weights[i];
    }
    line.center /= total;
    Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
    for (std::size_t i = 0; i < members.size(); ++i) {
      const Eigen::Vector2d d = edges[static_cast<std::size_t>(members[i])].in_plane - line.center;
      scatter += weights[i] * d * d.transpose();
    }
    line.normal = EigenOf(scatter).vectors.col(0);
    line.offset = line.normal.dot(line.center);
    for (std::size_t i = 0; i < members.size(); ++i) {
      const double distance = std::abs(
          line.normal.dot(edges[static_cast<std::size_t>(members[i])].in_plane) - line.offset);
      weights[i] = distance <= kHuber_m ? 1.0 : kHuber_m / distance;
    }
  }
  // Sandwich covariance of the weighted fit with the stated noise of each point.
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d noise = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < members.size(); ++i) {
    const EdgePoint& edge = edges[static_cast<std::size_t>(members[i])];
    const Eigen::RowVector2d j = line.MovedAt(edge.in_plane);
    const double variance = edge.VarianceAcross(line.normal);
    information += weights[i] * j.transpose() * j;
    noise += weights[i] * weights[i] * variance * j.transpose() * j;
  }
  const Eigen::Matrix2d inverse = information.inverse();
  line.covariance = inverse * noise * inverse;
  line.covariance(1, 1) += SharedVariance(edges, members, line);
  SubtractGrowth(edges, members, weights, line);
  return line;
}

}  // namespace

Expected<LidarCorners> CornersByPlaneLines(const BoardPatch& patch, const Board& board) {
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<std::vector<int>> groups, GroupBySide(patch, board));
  std::vector<PlaneLine> lines;
  for (const std::vector<int>& members : groups) lines.push_back(FitLine(patch.edges, members));

  LidarCorners corners;
  corners.board = patch.board;
  const int count = SidesOf(board);
  Eigen::MatrixXd by_plane(3 * count, 3);
  Eigen::MatrixXd by_lines = Eigen::MatrixXd::Zero(3 * count, 2 * count);
  Eigen::VectorXd by_growth(3 * count);
  Eigen::MatrixXd of_lines = Eigen::MatrixXd::Zero(2 * count, 2 * count);
  Eigen::Matrix<double, 3, 2> axes;
  axes << patch.plane.x_axis, patch.plane.y_axis;
  for (int i = 0; i < count; ++i) {
    const int a = SideBefore(i);
    const int b = SideAfter(i);
    const PlaneLine& before = lines[static_cast<std::size_t>(a)];
    const PlaneLine& after = lines[static_cast<std::size_t>(b)];
    Eigen::Matrix2d normals;
    normals << before.normal.transpose(), after.normal.transpose();
    if (std::abs(normals.determinant()) < 0.1) {
      return MakeError(
          ErrorCode::kDegenerate,
          fmt::format("board {}: the edges that meet at corner {} are parallel", board.id, i));
    }
    const Eigen::Matrix2d inverse = normals.inverse();
    const Eigen::Vector2d corner = inverse * Eigen::Vector2d(before.offset, after.offset);
    corners.in_lidar.push_back(patch.plane.At(corner));
    by_plane.middleRows<3>(3 * i) = MovedByPlane(patch.plane, patch.fit.center, corner);
    by_lines.block<3, 2>(3 * i, 2 * a) = axes * inverse.col(0) * before.MovedAt(corner);
    by_lines.block<3, 2>(3 * i, 2 * b) = axes * inverse.col(1) * after.MovedAt(corner);
    by_growth.segment<3>(3 * i) =
        axes * inverse * Eigen::Vector2d(before.growth_sigma, after.growth_sigma);
    of_lines.block<2, 2>(2 * i, 2 * i) = lines[static_cast<std::size_t>(i)].covariance;
  }
  corners.covariance = by_plane * patch.plane.covariance * by_plane.transpose() +
                       by_lines * of_lines * by_lines.transpose() +
                       by_growth * by_growth.transpose();
  corners.checks = ChecksOf(patch, board, corners.in_lidar);
  return corners;
}

}  // namespace sextant
