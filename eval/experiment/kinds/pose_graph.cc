// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/kinds/pose_graph.h"

#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/nearest_name.h"
#include "geometry/symmetric.h"

namespace sextant {
namespace {

// An edge with the indices of its frames and its information matrix.
struct Link {
  std::size_t from = 0;
  std::size_t to = 0;
  Rigid3d to_from{};
  Matrix6d information{};
};

std::string NameOf(const PoseEdge& edge) { return edge.to + " from " + edge.from; }

Expected<Matrix6d> InformationOf(const PoseEdge& edge) {
  if (!edge.to_from.b_from_a.IsFinite() || !edge.to_from.covariance.allFinite()) {
    return MakeError(ErrorCode::kNonFinite,
                     fmt::format("{}: the pose or its covariance is not finite", NameOf(edge)));
  }
  if (edge.from == edge.to) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("{}: expected two different sensors", NameOf(edge)));
  }
  const std::optional<Matrix6d> information = InvertSymmetric(edge.to_from.covariance);
  if (!information) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("{}: the covariance is not positive definite; every calibration "
                                 "in a graph needs a valid covariance",
                                 NameOf(edge)));
  }
  return *information;
}

std::size_t NumberOf(const std::string& name, std::vector<std::string>& frames) {
  const auto found = std::ranges::find(frames, name);
  const auto number = static_cast<std::size_t>(found - frames.begin());
  if (found == frames.end()) frames.push_back(name);
  return number;
}

// Poses along the shortest chains of edges from the reference (breadth-first); none for an
// unreachable frame.
std::vector<std::optional<Rigid3d>> ChainedPoses(const std::vector<Link>& links,
                                                 std::size_t frames) {
  std::vector<std::optional<Rigid3d>> poses(frames);
  poses[0] = Rigid3d{};
  std::vector<std::size_t> reached = {0};
  for (std::size_t next = 0; next < reached.size(); ++next) {
    const std::size_t at = reached[next];
    for (const Link& link : links) {
      const bool forward = link.from == at;
      if (!forward && link.to != at) continue;
      const std::size_t other = forward ? link.to : link.from;
      if (poses[other]) continue;
      poses[other] = (forward ? link.to_from : link.to_from.Inverse()) * *poses[at];
      reached.push_back(other);
    }
  }
  return poses;
}

// Jacobians of to_from_reference * (from_from_reference)^-1 with respect to both poses.
std::pair<Matrix6d, Matrix6d> JacobiansBetween(const Rigid3d& to, const Rigid3d& from) {
  const ProductJacobians by = JacobiansOfProduct(to, from.Inverse());
  return {by.by_left, by.by_right * JacobianOfInverse(from)};
}

struct NormalEquations {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
  double chi_square = 0.0;
};

// The reference is fixed: frame i has the six columns from 6 (i - 1) on.
NormalEquations Linearise(const std::vector<Link>& links, const std::vector<Rigid3d>& poses) {
  const auto size = 6 * static_cast<Eigen::Index>(poses.size() - 1);
  NormalEquations normal{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size), 0.0};
  for (const Link& link : links) {
    const Rigid3d implied = poses[link.to] * poses[link.from].Inverse();
    const Vector6d residual = PoseDifference(link.to_from, implied);
    Matrix6d by_implied = -Matrix6d::Identity();
    by_implied.topLeftCorner<3, 3>() = -LeftJacobianSo3(-residual.head<3>()).inverse();
    const auto [by_to, by_from] = JacobiansBetween(poses[link.to], poses[link.from]);
    const std::pair<std::size_t, Matrix6d> parts[] = {{link.to, by_implied * by_to},
                                                      {link.from, by_implied * by_from}};
    normal.chi_square += residual.dot(link.information * residual);
    for (const auto& [frame, by_frame] : parts) {
      if (frame == 0) continue;
      const auto row = 6 * static_cast<Eigen::Index>(frame - 1);
      normal.gradient.segment<6>(row) += by_frame.transpose() * link.information * residual;
      for (const auto& [other, by_other] : parts) {
        if (other == 0) continue;
        normal.information.block<6, 6>(row, 6 * static_cast<Eigen::Index>(other - 1)) +=
            by_frame.transpose() * link.information * by_other;
      }
    }
  }
  return normal;
}

std::vector<Rigid3d> Moved(const std::vector<Rigid3d>& poses, const Eigen::VectorXd& step) {
  std::vector<Rigid3d> moved = poses;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    moved[i] = Perturb(poses[i], step.segment<6>(6 * static_cast<Eigen::Index>(i - 1)));
  }
  return moved;
}

}  // namespace

Expected<SensorGraph> SensorGraph::Solve(const std::vector<PoseEdge>& edges) {
  constexpr int kMaxIterations = 50;
  constexpr int kMaxHalvings = 20;
  constexpr double kSmallestStep = 1e-11;  // Metres and radians.
  if (edges.empty()) {
    return MakeError(ErrorCode::kMissingData, "expected at least one measured transform, got none");
  }
  SensorGraph graph;
  std::vector<Link> links;
  for (const PoseEdge& edge : edges) {
    SEXTANT_ASSIGN_OR_RETURN(const Matrix6d information, InformationOf(edge));
    const std::size_t from = NumberOf(edge.from, graph.frames_);
    const std::size_t to = NumberOf(edge.to, graph.frames_);
    links.push_back({from, to, edge.to_from.b_from_a, information});
  }
  std::vector<Rigid3d> poses;
  for (const std::optional<Rigid3d>& pose : ChainedPoses(links, graph.frames_.size())) {
    if (!pose) {
      return MakeError(ErrorCode::kDegenerate,
                       fmt::format("no chain of measured transforms joins {} to {}",
                                   graph.frames_[poses.size()], graph.frames_[0]));
    }
    poses.push_back(*pose);
  }
  NormalEquations normal = Linearise(links, poses);
  bool converged = false;
  for (int i = 0; i < kMaxIterations && !converged; ++i) {
    Eigen::VectorXd step = -SolveSymmetric(normal.information, normal.gradient);
    std::vector<Rigid3d> moved = Moved(poses, step);
    NormalEquations next = Linearise(links, moved);
    for (int k = 0; k < kMaxHalvings && next.chi_square > normal.chi_square; ++k) {
      step *= 0.5;
      moved = Moved(poses, step);
      next = Linearise(links, moved);
    }
    converged = step.norm() < kSmallestStep * static_cast<double>(poses.size());
    if (next.chi_square > normal.chi_square) break;
    poses = std::move(moved);
    normal = std::move(next);
  }
  const std::optional<Eigen::MatrixXd> covariance = InvertSymmetric(normal.information);
  if (!converged || !covariance) {
    return MakeError(ErrorCode::kNoConvergence,
                     "the measured transforms contradict each other too much to be reconciled; "
                     "check the loops of the graph one by one");
  }
  graph.frame_from_reference_ = std::move(poses);
  graph.covariance_ = *covariance;
  graph.chi_square_ = normal.chi_square;
  graph.redundancy_ = 6 * (static_cast<int>(links.size() - graph.frames_.size()) + 1);
  return graph;
}

Expected<std::size_t> SensorGraph::Find(std::string_view name) const {
  const auto found = std::ranges::find(frames_, name);
  if (found != frames_.end()) return static_cast<std::size_t>(found - frames_.begin());
  return MakeError(ErrorCode::kUnknownName,
                   fmt::format("no sensor '{}'; {}", name, SuggestName(name, frames_)));
}

Expected<UncertainPose> SensorGraph::Between(std::string_view to, std::string_view from) const {
  SEXTANT_ASSIGN_OR_RETURN(const std::size_t a, Find(from));
  SEXTANT_ASSIGN_OR_RETURN(const std::size_t b, Find(to));
  UncertainPose pose;
  pose.b_from_a = frame_from_reference_[b] * frame_from_reference_[a].Inverse();
  const auto [by_to, by_from] =
      JacobiansBetween(frame_from_reference_[b], frame_from_reference_[a]);
  const std::pair<std::size_t, Matrix6d> parts[] = {{b, by_to}, {a, by_from}};
  for (const auto& [frame, by_frame] : parts) {
    for (const auto& [other, by_other] : parts) {
      if (frame == 0 || other == 0) continue;
      pose.covariance += by_frame *
                         covariance_.block<6, 6>(6 * static_cast<Eigen::Index>(frame - 1),
                                                 6 * static_cast<Eigen::Index>(other - 1)) *
                         by_other.transpose();
    }
  }
  return pose;
}

}  // namespace sextant
