// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/pair_diagnostics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>

#include "eval/diagnostics/causes.h"
#include "eval/diagnostics/complete_boards.h"
#include "geometry/pair_noise.h"
#include "geometry/symmetric.h"
#include "solvers/core/local_frame.h"
#include "solvers/kernels/kabsch.h"

namespace sextant {
namespace {

constexpr double kMinEdgeDifference = 0.05;  // Relative to the edge's length.
constexpr double kWeakRatio = 5.0;

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

using EdgesById = std::map<int, std::array<double, kCornersPerBoard>>;

EdgesById KnownEdges(const CalibrationProblem& problem) {
  EdgesById edges;
  for (const Board& board : problem.boards) edges.emplace(board.id, board.EdgeLengths());
  return edges;
}

std::optional<double> KnownLength(const EdgesById& edges, int board_id, int edge) {
  const auto board = edges.find(board_id);
  if (board == edges.end()) return std::nullopt;
  return board->second[static_cast<std::size_t>(edge)];
}

// The number of sigmas that one of the edges exceeds by noise alone with a probability of 1 %.
double SigmasOfEdges(std::size_t edges) {
  constexpr double kChance = 0.01;
  return std::sqrt(2.0 * std::log(static_cast<double>(edges) / kChance));
}

// By how much the edge's error exceeds what noise explains; zero or negative if noise explains it.
double Excess(const Edge& edge, std::optional<double> known, double sigmas) {
  const double reference = known.value_or(edge.in_cam_m);
  double difference = std::abs(edge.in_cam_m - edge.in_lidar_m);
  if (known) {
    difference = std::max(
        {difference, std::abs(edge.in_cam_m - *known), std::abs(edge.in_lidar_m - *known)});
  }
  return difference - std::max(kMinEdgeDifference * reference, sigmas * edge.sigma_m);
}

std::vector<EdgeFinding> DiagnoseEdges(const CalibrationProblem& problem) {
  std::vector<EdgeFinding> findings;
  const EdgesById known_edges = KnownEdges(problem);
  const std::vector<BoardPairs> boards = CompleteBoards(problem.pairs_3d3d);
  const double sigmas = SigmasOfEdges(kCornersPerBoard * boards.size());
  for (const BoardPairs& group : boards) {
    double worst = 0.0;
    std::optional<EdgeFinding> finding;
    for (int i = 0; i < kCornersPerBoard; ++i) {
      const Pair3d3d& from = problem.pairs_3d3d[group.pair(i)];
      const Pair3d3d& to = problem.pairs_3d3d[group.pair((i + 1) % kCornersPerBoard)];
      const Edge edge = MeasureEdge(from, to);
      const std::optional<double> known = KnownLength(known_edges, from.id.board, i);
      const double excess = Excess(edge, known, sigmas);
      if (excess <= worst) continue;
      worst = excess;
      finding = EdgeFinding{from.id.view, from.id.board, i, edge.in_cam_m, edge.in_lidar_m, known};
    }
    if (finding) findings.push_back(*finding);
  }
  return findings;
}

// The points of complete boards, board after board, with the pose of each board alone.
struct BoardsAlone {
  std::vector<Eigen::Vector3d> in_cam;
  std::vector<Eigen::Vector3d> in_lidar;
  std::vector<Rigid3d> poses;
  double sum_squares = 0.0;
  double mean_edge_m = 0.0;
};

BoardsAlone FitBoardsAlone(std::span<const Pair3d3d> pairs) {
  BoardsAlone boards;
  for (const BoardPairs& group : CompleteBoards(pairs)) {
    std::array<Eigen::Vector3d, kCornersPerBoard> in_cam;
    std::array<Eigen::Vector3d, kCornersPerBoard> in_lidar;
    for (int i = 0; i < kCornersPerBoard; ++i) {
      in_cam[static_cast<std::size_t>(i)] = pairs[group.pair(i)].point_in_cam;
      in_lidar[static_cast<std::size_t>(i)] = pairs[group.pair(i)].point_in_lidar;
    }
    const Expected<KabschFit> fit = FitKabsch(in_cam, in_lidar);
    if (!fit) continue;
    boards.in_cam.insert(boards.in_cam.end(), in_cam.begin(), in_cam.end());
    boards.in_lidar.insert(boards.in_lidar.end(), in_lidar.begin(), in_lidar.end());
    boards.poses.push_back(fit->b_from_a);
    boards.sum_squares += fit->sum_squares;
    for (std::size_t i = 0; i < 4; ++i) {
      boards.mean_edge_m += 0.25 * (in_cam[(i + 1) % 4] - in_cam[i]).norm();
    }
  }
  boards.mean_edge_m /= std::max(1.0, static_cast<double>(boards.poses.size()));
  return boards;
}

// The largest distance between a board's centres by its own pose and by that of the board before
// or after it: all pairs of boards would be a quadratic number.
double LargestDistance(const BoardsAlone& boards) {
  double largest = 0.0;
  for (std::size_t i = 0; i < boards.poses.size(); ++i) {
    const std::size_t other = i + 1 < boards.poses.size() ? i + 1 : i - 1;
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < 4; ++k) center += 0.25 * boards.in_lidar[4 * i + k];
    largest = std::max(largest, (boards.poses[i] * center - boards.poses[other] * center).norm());
  }
  return largest;
}

std::optional<BoardContradiction> FindContradiction(std::span<const Pair3d3d> pairs) {
  constexpr double kOfAlone = 3.0;
  constexpr double kOfEdge = 0.1;
  const BoardsAlone boards = FitBoardsAlone(pairs);
  if (boards.poses.size() < 2) return std::nullopt;
  const Expected<KabschFit> together = FitKabsch(boards.in_cam, boards.in_lidar);
  if (!together) return std::nullopt;
  const auto points = static_cast<double>(boards.in_cam.size());
  const BoardContradiction found{.rmse_together_m = std::sqrt(together->sum_squares / points),
                                 .rmse_alone_m = std::sqrt(boards.sum_squares / points),
                                 .apart_m = LargestDistance(boards)};
  const double least = std::max(kOfAlone * found.rmse_alone_m, kOfEdge * boards.mean_edge_m);
  if (found.rmse_together_m < least) return std::nullopt;
  return found;
}

std::optional<WeakDirection> Weakest(const Eigen::Matrix3d& covariance, bool is_rotation) {
  const SymmetricEigen<3> eigen = EigenOf(covariance);
  const Eigen::Vector3d sigma = eigen.values.cwiseMax(0.0).cwiseSqrt();
  if (sigma(2) <= kWeakRatio * sigma(0)) return std::nullopt;
  return WeakDirection{is_rotation, eigen.vectors.col(2), sigma(2), sigma(0)};
}

void Append(const std::vector<std::string>& lines, std::vector<std::string>& all) {
  all.insert(all.end(), lines.begin(), lines.end());
}

}  // namespace

PairDiagnostics DiagnosePairs(const CalibrationProblem& problem) {
  PairDiagnostics diagnostics;
  diagnostics.causes = CausesInCamera(problem);
  const std::vector<std::string> in_pixels = CausesInPixels(problem);
  const std::vector<std::string> in_points = CausesInPoints(problem);
  Append(in_pixels, diagnostics.causes);
  Append(in_points, diagnostics.causes);
  diagnostics.misread = !in_pixels.empty() || !in_points.empty();
  if (!diagnostics.misread) {
    for (auto& cause : {OtherIntrinsics(problem), SlightScale(problem)}) {
      if (cause) diagnostics.causes.push_back(*cause);
    }
  }
  if (!in_points.empty()) return diagnostics;
  diagnostics.order = DiagnoseOrder(problem);
  if (problem.pairs_3d3d.size() < 3) return diagnostics;
  const CalibrationProblem ordered =
      diagnostics.order.better ? Reordered(problem, *diagnostics.order.better) : problem;
  diagnostics.edges = DiagnoseEdges(ordered);
  diagnostics.contradiction = FindContradiction(ordered.pairs_3d3d);

  // At a far origin every translation is weak, as the rotation's error moves it.
  const auto frame = LocalFrame::For(ordered, {.pairs_3d3d = 3});
  const std::vector<Pair3d3d> pairs =
      frame ? frame->Localised(ordered).pairs_3d3d : ordered.pairs_3d3d;
  const std::vector<double> weights(pairs.size(), 1.0);
  const PointSets points = PointsOf(pairs);
  if (const auto reflection = FindReflection(points.in_cam, points.in_lidar)) {
    diagnostics.mirrored_rmse_m = reflection->rmse_m;
  }
  const Expected<KabschFit> fit = FitKabsch(points.in_cam, points.in_lidar, weights);
  if (!fit) return diagnostics;
  if (const auto covariance = PropagateCovariance(pairs, weights, fit->b_from_a)) {
    diagnostics.weak_rotation = Weakest(covariance->topLeftCorner<3, 3>(), true);
    diagnostics.weak_translation = Weakest(covariance->bottomRightCorner<3, 3>(), false);
  }
  return diagnostics;
}

bool RefutesPoses(const PairDiagnostics& diagnostics, bool reordered) {
  const OrderDiagnosis& order = diagnostics.order;
  if (diagnostics.misread || diagnostics.mirrored_rmse_m) return true;
  if (reordered && order.better) return false;
  return order.faces_as_given || order.better || !order.rivals.empty();
}

}  // namespace sextant
