// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/pair_diagnostics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>

#include "eval/diagnostics/causes.h"
#include "eval/diagnostics/complete_boards.h"
#include "eval/diagnostics/unexplained_pairs.h"
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

std::optional<WeakDirection> Weakest(const Eigen::Matrix3d& covariance, bool is_rotation) {
  const SymmetricEigen<3> eigen = EigenOf(covariance);
  const Eigen::Vector3d sigma = eigen.values.cwiseMax(0.0).cwiseSqrt();
  if (sigma(2) <= kWeakRatio * sigma(0)) return std::nullopt;
  return WeakDirection{is_rotation, eigen.vectors.col(2), sigma(2), sigma(0)};
}

// Whether the RMS residual is a larger share of the spread than measurements leave.
bool IsUnexplained(const std::vector<Eigen::Vector3d>& points, double sum_squares) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) mean += point / static_cast<double>(points.size());
  double spread = 0.0;
  for (const Eigen::Vector3d& point : points) spread += (point - mean).squaredNorm();
  return sum_squares > kMaxUnexplainedShare * kMaxUnexplainedShare * spread;
}

void AddWeakDirections(const CalibrationProblem& problem, PairDiagnostics& diagnostics) {
  // At a far origin every translation is weak, as the rotation's error moves it.
  const auto frame = LocalFrame::For(problem, {.pairs_3d3d = 3});
  const std::vector<Pair3d3d> pairs =
      frame ? frame->Localised(problem).pairs_3d3d : problem.pairs_3d3d;
  const std::vector<double> weights(pairs.size(), 1.0);
  const PointSets points = PointsOf(pairs);
  const Expected<KabschFit> fit = FitKabsch(points.in_cam, points.in_lidar, weights);
  // The directions of a pose that does not fit mean nothing.
  if (!fit || IsUnexplained(points.in_cam, fit->sum_squares)) return;
  if (const auto covariance = PropagateCovariance(pairs, weights, fit->b_from_a)) {
    diagnostics.weak_rotation = Weakest(covariance->topLeftCorner<3, 3>(), true);
    diagnostics.weak_translation = Weakest(covariance->bottomRightCorner<3, 3>(), false);
  }
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
  const std::optional<std::string> scale =
      diagnostics.misread ? std::nullopt : SlightScale(problem);
  if (!diagnostics.misread) {
    for (const auto& cause : {OtherIntrinsics(problem), scale}) {
      if (cause) diagnostics.causes.push_back(*cause);
    }
  }
  if (!in_points.empty()) return diagnostics;
  diagnostics.order = DiagnoseOrder(problem);
  const CalibrationProblem ordered =
      diagnostics.order.better ? Reordered(problem, *diagnostics.order.better) : problem;
  const bool is_in_order = diagnostics.order.rivals.empty() &&
                           (diagnostics.order.better || !diagnostics.order.faces_as_given);
  if (is_in_order && !diagnostics.misread) diagnostics.contradiction = FindContradiction(ordered);
  if (problem.pairs_3d3d.size() < 3) return diagnostics;
  if (!scale) diagnostics.edges = DiagnoseEdges(ordered);

  const PointSets points = PointsOf(ordered.pairs_3d3d);
  if (const auto reflection = FindReflection(points.in_cam, points.in_lidar)) {
    diagnostics.mirrored_rmse_m = reflection->rmse_m;
  }
  if (is_in_order) AddWeakDirections(ordered, diagnostics);
  return diagnostics;
}

PairDiagnostics ForAnswer(PairDiagnostics diagnostics, const CalibrationProblem& problem,
                          const SolveReport& report) {
  const bool is_of_points = !problem.pairs_3d3d.empty() && problem.pairs_2d3d.empty();
  const bool leaves_out =
      !report.inliers.empty() && report.inliers.size() < problem.pairs_3d3d.size();
  if (!is_of_points || !leaves_out || diagnostics.misread) return diagnostics;
  diagnostics.weak_rotation.reset();
  diagnostics.weak_translation.reset();
  CalibrationProblem used = problem;
  used.pairs_3d3d.clear();
  for (const int i : report.inliers) {
    used.pairs_3d3d.push_back(problem.pairs_3d3d[static_cast<std::size_t>(i)]);
  }
  AddWeakDirections(used, diagnostics);
  return diagnostics;
}

bool RefutesPoses(const PairDiagnostics& diagnostics, bool reordered) {
  const OrderDiagnosis& order = diagnostics.order;
  if (diagnostics.misread || diagnostics.mirrored_rmse_m) return true;
  const bool is_undecided = diagnostics.contradiction && diagnostics.contradiction->is_undecided;
  if (is_undecided) return true;
  if (reordered && order.better) return false;
  return order.faces_as_given || order.better || !order.rivals.empty();
}

}  // namespace sextant
