// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/pair_diagnostics.h"

#include <algorithm>
#include <cmath>

#include "eval/diagnostics/order_diagnostics.h"
#include "geometry/pair_noise.h"
#include "geometry/symmetric.h"
#include "solvers/kernels/kabsch.h"

namespace sextant {
namespace {

constexpr double kMinEdgeDifference = 0.05;  // Relative to the edge's length.
constexpr double kEdgeSigmas = 3.0;
constexpr double kWeakRatio = 5.0;
constexpr double kMirroredRatio = 2.0;

struct Edge {
  double in_cam_m = 0.0;
  double in_lidar_m = 0.0;
  // Standard deviation of the difference of the two; 0 if the noise is unknown.
  double sigma_m = 0.0;
};

Edge MeasureEdge(const Pair3d3d& from, const Pair3d3d& to) {
  Edge edge;
  const Eigen::Vector3d along = to.point_in_cam - from.point_in_cam;
  edge.in_cam_m = along.norm();
  edge.in_lidar_m = (to.point_in_lidar - from.point_in_lidar).norm();
  if (HasKnownNoise(from)) {
    const Eigen::Vector3d u = along.normalized();
    edge.sigma_m = std::sqrt(u.dot((StatedCovariance(from) + StatedCovariance(to)) * u));
  }
  return edge;
}

std::optional<double> KnownLength(const CalibrationProblem& problem, int board_id, int edge) {
  for (const Board& board : problem.boards) {
    if (board.id == board_id) return board.EdgeLengths()[static_cast<std::size_t>(edge)];
  }
  return std::nullopt;
}

// By how much the edge's error exceeds what noise explains; zero or negative if noise explains it.
double Excess(const Edge& edge, std::optional<double> known) {
  const double reference = known.value_or(edge.in_cam_m);
  double difference = std::abs(edge.in_cam_m - edge.in_lidar_m);
  if (known) {
    difference = std::max(
        {difference, std::abs(edge.in_cam_m - *known), std::abs(edge.in_lidar_m - *known)});
  }
  return difference - std::max(kMinEdgeDifference * reference, kEdgeSigmas * edge.sigma_m);
}

std::vector<EdgeFinding> DiagnoseEdges(const CalibrationProblem& problem) {
  std::vector<EdgeFinding> findings;
  for (const BoardPairs& group : CompleteBoards(problem.pairs_3d3d)) {
    double worst = 0.0;
    std::optional<EdgeFinding> finding;
    for (int i = 0; i < kCornersPerBoard; ++i) {
      const Pair3d3d& from = problem.pairs_3d3d[group.pair(i)];
      const Pair3d3d& to = problem.pairs_3d3d[group.pair((i + 1) % kCornersPerBoard)];
      const Edge edge = MeasureEdge(from, to);
      const std::optional<double> known = KnownLength(problem, from.id.board, i);
      const double excess = Excess(edge, known);
      if (excess <= worst) continue;
      worst = excess;
      finding = EdgeFinding{from.id.view, from.id.board, i, edge.in_cam_m, edge.in_lidar_m, known};
    }
    if (finding) findings.push_back(*finding);
  }
  return findings;
}

std::optional<WeakDirection> Weakest(const Eigen::Matrix3d& covariance, bool is_rotation) {
  const SymmetricEigen<3> eigen = EigenOf(covariance);
  const Eigen::Vector3d sigma = eigen.values.cwiseMax(0.0).cwiseSqrt();
  if (sigma(2) <= kWeakRatio * sigma(0)) return std::nullopt;
  return WeakDirection{is_rotation, eigen.vectors.col(2), sigma(2), sigma(0)};
}

}  // namespace

CalibrationProblem Reordered(const CalibrationProblem& problem, const OrderFinding& order) {
  CalibrationProblem reordered = problem;
  for (std::size_t i = 0; i < order.lidar_index.size(); ++i) {
    const auto from = static_cast<std::size_t>(order.lidar_index[i]);
    reordered.pairs_3d3d[i].point_in_lidar = problem.pairs_3d3d[from].point_in_lidar;
    // The 2D-3D pairs of the same corner change with it.
    for (Pair2d3d& pair : reordered.pairs_2d3d) {
      if (pair.id != problem.pairs_3d3d[i].id) continue;
      pair.point_in_lidar = problem.pairs_3d3d[from].point_in_lidar;
    }
  }
  return reordered;
}

PairDiagnostics DiagnosePairs(const CalibrationProblem& problem) {
  PairDiagnostics diagnostics;
  if (problem.pairs_3d3d.size() < 3) return diagnostics;
  diagnostics.order = FindBetterOrder(problem.pairs_3d3d);
  const CalibrationProblem ordered =
      diagnostics.order ? Reordered(problem, *diagnostics.order) : problem;
  diagnostics.edges = DiagnoseEdges(ordered);

  const std::vector<Pair3d3d>& pairs = ordered.pairs_3d3d;
  const std::vector<double> weights(pairs.size(), 1.0);
  const PointSets points = PointsOf(pairs);
  const Expected<KabschFit> fit = FitKabsch(points.in_cam, points.in_lidar, weights);
  if (!fit) return diagnostics;
  if (fit->sum_squares > kMirroredRatio * kMirroredRatio * fit->mirrored_sum_squares &&
      fit->sum_squares > 1e-12 * points.in_cam.front().squaredNorm()) {
    diagnostics.mirrored_rmse_m =
        std::sqrt(fit->mirrored_sum_squares / static_cast<double>(pairs.size()));
  }
  if (const auto covariance = PropagateCovariance(pairs, weights, fit->b_from_a)) {
    diagnostics.weak_rotation = Weakest(covariance->topLeftCorner<3, 3>(), true);
    diagnostics.weak_translation = Weakest(covariance->bottomRightCorner<3, 3>(), false);
  }
  return diagnostics;
}

}  // namespace sextant
