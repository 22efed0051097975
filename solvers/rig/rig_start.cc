// SPDX-License-Identifier: Apache-2.0
#include "solvers/rig/rig_start.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/median.h"
#include "geometry/symmetric.h"
#include "solvers/core/board_view_check.h"
#include "solvers/kernels/kabsch.h"

namespace sextant {
namespace {

using Corners = std::array<Eigen::Vector3d, kCornersPerBoard>;

// How far the corners of a board lie apart when the sensors' poses of it agree.
constexpr double kUsual_m = 0.03;

Corners CornersAt(const Rigid3d& sensor_from_board, const Board& board) {
  const double x = 0.5 * board.top_right_m;
  const double y = 0.5 * board.right_bottom_m;
  return {sensor_from_board * Eigen::Vector3d(-x, -y, 0.0),
          sensor_from_board * Eigen::Vector3d(x, -y, 0.0),
          sensor_from_board * Eigen::Vector3d(x, y, 0.0),
          sensor_from_board * Eigen::Vector3d(-x, y, 0.0)};
}

double MeanSquare(const Rigid3d& a_from_b, const Corners& in_a, const Corners& in_b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < in_a.size(); ++k) sum += (in_a[k] - a_from_b * in_b[k]).squaredNorm();
  return sum / kCornersPerBoard;
}

double Limited(double squared) { return std::log1p(squared); }

/// A board that two sensors see, by every pose that each allows.
struct SeenByBoth {
  std::vector<std::pair<Corners, Corners>> choices;
  std::vector<Rigid3d> a_from_b;

  std::size_t BestAt(const Rigid3d& pose) const {
    std::size_t best = 0;
    for (std::size_t k = 1; k < choices.size(); ++k) {
      if (CostOf(k, pose) < CostOf(best, pose)) best = k;
    }
    return best;
  }
  double CostOf(std::size_t k, const Rigid3d& pose) const {
    return MeanSquare(pose, choices[k].first, choices[k].second);
  }
};

// The pose of one of the boards that the others agree with best.
std::optional<Rigid3d> ConsensusOf(const std::vector<SeenByBoth>& boards) {
  constexpr std::size_t kMaxTried = 60;
  std::optional<Rigid3d> best;
  double lowest = std::numeric_limits<double>::infinity();
  const std::size_t step = 1 + boards.size() / kMaxTried;
  for (std::size_t i = 0; i < boards.size(); i += step) {
    for (const Rigid3d& pose : boards[i].a_from_b) {
      double cost = 0.0;
      for (std::size_t j = 0; j < boards.size(); j += step) {
        cost += Limited(boards[j].CostOf(boards[j].BestAt(pose), pose) / (kUsual_m * kUsual_m));
      }
      if (cost < lowest) {
        lowest = cost;
        best = pose;
      }
    }
  }
  return best;
}

// Least squares of the corners, without the boards whose corners lie more than three times as far
// apart as usual.
Rigid3d Refitted(const std::vector<SeenByBoth>& boards, Rigid3d pose) {
  for (int round = 0; round < 5; ++round) {
    std::vector<double> off;
    for (const SeenByBoth& board : boards) {
      off.push_back(std::sqrt(board.CostOf(board.BestAt(pose), pose)));
    }
    std::vector<double> sorted = off;
    const double limit = std::max(3.0 * UpperMedian(sorted), 1e-6);
    std::vector<Eigen::Vector3d> in_a;
    std::vector<Eigen::Vector3d> in_b;
    for (std::size_t i = 0; i < boards.size(); ++i) {
      if (off[i] > limit) continue;
      const auto& [a, b] = boards[i].choices[boards[i].BestAt(pose)];
      in_a.insert(in_a.end(), a.begin(), a.end());
      in_b.insert(in_b.end(), b.begin(), b.end());
    }
    const auto fit = FitKabsch(in_a, in_b);
    if (!fit) return pose;
    pose = fit->b_from_a;
  }
  return pose;
}

// n_a = R n_b and n_a . t = d_a - d_b: of three or more planes that are not parallel to one line.
std::optional<Rigid3d> FromPlanes(
    const std::vector<std::pair<BoardPlaneAlone, BoardPlaneAlone>>& planes) {
  std::vector<Eigen::Vector3d> in_a;
  std::vector<Eigen::Vector3d> in_b;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const auto& [a, b] : planes) {
    for (const double sign : {1.0, -1.0}) {
      in_a.push_back(sign * a.normal);
      in_b.push_back(sign * b.normal);
    }
    normal += a.normal * a.normal.transpose();
    right += a.normal * (a.distance_m - b.distance_m);
  }
  constexpr double kMinShare = 1e-4;
  const Eigen::Vector3d spread = EigenOf<3>(normal).values;
  if (planes.size() < 3 || !(spread[0] > kMinShare * spread[2])) return std::nullopt;
  const auto fit = FitKabsch(in_a, in_b);
  if (!fit) return std::nullopt;
  return Rigid3d{fit->b_from_a.rotation, SolveSymmetric<3>(normal, right)};
}

/// The observations of every placement with their poses alone.
class SeenAlone {
 public:
  explicit SeenAlone(const RigProblem& problem) : problem_(problem) {
    for (const RigPlacement& placement : problem.placements) {
      poses_.emplace_back();
      const Board& board = *FindBoard(problem.boards, placement.board);
      for (const RigObservation& seen : placement.seen) {
        poses_.back().push_back(PosesAlone(seen, problem.sensors[seen.sensor], board));
      }
    }
  }

  RigPair PairOf(std::size_t a, std::size_t b) const {
    RigPair pair{.a = a, .b = b};
    std::vector<SeenByBoth> boards;
    std::vector<std::pair<BoardPlaneAlone, BoardPlaneAlone>> planes;
    for (std::size_t i = 0; i < problem_.placements.size(); ++i) {
      const auto nearest = NearestInTime(i, a, b);
      if (!nearest) continue;
      const auto& [in_a, in_b] = *nearest;
      pair.placements.push_back(i);
      SeenByBoth both = BothOf(i, in_a, in_b);
      if (!both.choices.empty()) boards.push_back(std::move(both));
      const auto plane_a = PlaneAlone(problem_.placements[i].seen[in_a], poses_[i][in_a]);
      const auto plane_b = PlaneAlone(problem_.placements[i].seen[in_b], poses_[i][in_b]);
      if (plane_a && plane_b) planes.emplace_back(*plane_a, *plane_b);
    }
    if (const auto pose = ConsensusOf(boards)) {
      pair.a_from_b = Refitted(boards, *pose);
    } else {
      pair.a_from_b = FromPlanes(planes);
    }
    return pair;
  }

 private:
  // The observations by two sensors between which the board moved least; without times the only
  // ones.
  std::optional<std::pair<std::size_t, std::size_t>> NearestInTime(std::size_t placement,
                                                                   std::size_t a,
                                                                   std::size_t b) const {
    const auto& seen = problem_.placements[placement].seen;
    std::optional<std::pair<std::size_t, std::size_t>> nearest;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < seen.size(); ++i) {
      for (std::size_t j = 0; j < seen.size(); ++j) {
        if (seen[i].sensor != a || seen[j].sensor != b) continue;
        const double between =
            std::abs(seen[i].time_s.value_or(0.0) - seen[j].time_s.value_or(0.0));
        if (nearest && between >= least) continue;
        least = between;
        nearest = std::pair(i, j);
      }
    }
    return nearest;
  }

  SeenByBoth BothOf(std::size_t placement, std::size_t in_a, std::size_t in_b) const {
    const Board& board = *FindBoard(problem_.boards, problem_.placements[placement].board);
    SeenByBoth both;
    for (const Rigid3d& a : poses_[placement][in_a]) {
      for (const Rigid3d& b : poses_[placement][in_b]) {
        both.choices.emplace_back(CornersAt(a, board), CornersAt(b, board));
        both.a_from_b.push_back(a * b.Inverse());
      }
    }
    return both;
  }

  const RigProblem& problem_;
  std::vector<std::vector<std::vector<Rigid3d>>> poses_;
};

// What would connect a sensor with the root, and why it is not.
std::string WhatIsMissing(const RigProblem& problem, const std::vector<RigPair>& pairs,
                          const RigTree& tree, std::size_t sensor) {
  const RigPair* nearest = nullptr;
  for (const RigPair& pair : pairs) {
    const std::size_t other = pair.a == sensor ? pair.b : pair.a;
    if ((pair.a != sensor && pair.b != sensor) || !tree.sensor_from_root[other]) continue;
    if (nearest == nullptr || pair.placements.size() > nearest->placements.size()) nearest = &pair;
  }
  const std::size_t other = nearest->a == sensor ? nearest->b : nearest->a;
  const std::string& name = problem.sensors[sensor].name;
  const std::string& partner = problem.sensors[other].name;
  if (nearest->placements.empty()) {
    return fmt::format(
        "sensor '{}' shares no view of a board with any sensor that has a pose: record 3 moments "
        "in which '{}' and, for instance, '{}' see a board",
        name, name, partner);
  }
  return fmt::format(
      "sensor '{}' shares {} views of a board with '{}', which do not determine its pose: record 3 "
      "moments in which both see a board at other places and tilts",
      name, nearest->placements.size(), partner);
}

double CostAt(std::span<const RigBlock> blocks, const RigState& state,
              const Rigid3d& root_from_board, const RigMotion& motion) {
  double cost = 0.0;
  RigResiduals at;
  for (const RigBlock& block : blocks) {
    const Rigid3d moved = MovedAfter(motion, TimeOf(state, block)).board_from_moved;
    if (!block.residuals(state.sensor_from_root[block.sensor] * root_from_board * moved, at)) {
      cost += 10.0 * block.units;
      continue;
    }
    for (int i = 0; i < block.units; ++i) {
      const auto of = at.value.segment(i * block.rows_per_unit, block.rows_per_unit);
      cost += Limited(of.squaredNorm() / (9.0 * block.rows_per_unit));
    }
  }
  return cost;
}

// A board of which only planes are known has one in the first of them.
Rigid3d AnyPoseIn(const BoardPlaneAlone& plane) {
  return {Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), plane.normal),
          plane.distance_m * plane.normal};
}

/// A place of a board with what it costs.
struct PlaceOfBoard {
  Rigid3d root_from_board;
  RigMotion motion;
  double cost = std::numeric_limits<double>::infinity();
};

/// Finds the place and the motion of one board.
class BoardStart {
 public:
  BoardStart(const RigProblem& problem, const RigPlacement& placement, bool moves,
             std::span<const RigBlock> blocks, const RigState& state)
      : placement_(placement), blocks_(blocks), state_(state) {
    const Board& board = *FindBoard(problem.boards, placement.board);
    for (const RigObservation& seen : placement.seen) {
      poses_.push_back(PosesAlone(seen, problem.sensors[seen.sensor], board));
    }
    // Blocks are in the order of the observations.
    times_s_.resize(placement.seen.size(), 0.0);
    for (const RigBlock& block : blocks) times_s_[block.seen] = block.time_s;
    motions_.emplace_back();
    for (std::size_t i = 0; i < poses_.size() && moves; ++i) AddMotionFrom(i);
  }

  PlaceOfBoard Best() const {
    PlaceOfBoard best;
    std::optional<Rigid3d> in_plane;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      const RigObservation& seen = placement_.seen[i];
      const Rigid3d root_from_sensor = state_.sensor_from_root[seen.sensor].Inverse();
      for (const Rigid3d& pose : poses_[i]) {
        for (const RigMotion& motion : motions_) Try(root_from_sensor * pose, i, motion, best);
      }
      const auto plane = PlaneAlone(seen, poses_[i]);
      if (!in_plane && plane) in_plane = root_from_sensor * AnyPoseIn(*plane);
    }
    if (!std::isfinite(best.cost)) best.root_from_board = in_plane.value_or(Rigid3d{});
    return best;
  }

 private:
  // By the first and the last time that one sensor sees it.
  void AddMotionFrom(std::size_t first) {
    const auto& seen = placement_.seen;
    std::size_t last = first;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (seen[i].sensor != seen[first].sensor) continue;
      if (times_s_[i] < times_s_[first]) return;
      if (times_s_[i] > times_s_[last]) last = i;
    }
    if (!(times_s_[last] > times_s_[first])) return;
    if (poses_[first].empty() || poses_[last].empty()) return;
    motions_.push_back(
        MotionBetween(poses_[first][0], poses_[last][0], times_s_[last] - times_s_[first]));
  }

  void Try(const Rigid3d& root_from_moved, std::size_t seen, const RigMotion& motion,
           PlaceOfBoard& best) const {
    const Rigid3d moved = MovedAfter(motion, times_s_[seen]).board_from_moved;
    const Rigid3d root_from_board = root_from_moved * moved.Inverse();
    const double cost = CostAt(blocks_, state_, root_from_board, motion);
    if (cost < best.cost) best = {root_from_board, motion, cost};
  }

  const RigPlacement& placement_;
  std::span<const RigBlock> blocks_;
  const RigState& state_;
  std::vector<std::vector<Rigid3d>> poses_;  ///< From each observation alone.
  std::vector<double> times_s_;
  std::vector<RigMotion> motions_;
};

}  // namespace

std::vector<RigPair> PairsOf(const RigProblem& problem) {
  const SeenAlone alone(problem);
  std::vector<RigPair> pairs;
  for (std::size_t a = 0; a < problem.sensors.size(); ++a) {
    for (std::size_t b = a + 1; b < problem.sensors.size(); ++b) {
      pairs.push_back(alone.PairOf(a, b));
    }
  }
  std::ranges::stable_sort(pairs, [](const RigPair& a, const RigPair& b) {
    return a.placements.size() > b.placements.size();
  });
  return pairs;
}

RigTree TreeOf(const RigProblem& problem, const std::vector<RigPair>& pairs, std::size_t root) {
  RigTree tree;
  tree.sensor_from_root.resize(problem.sensors.size());
  tree.sensor_from_root[root] = Rigid3d{};
  // Prim's algorithm: the best observed pair that adds a sensor.
  for (bool grown = true; grown;) {
    grown = false;
    for (const RigPair& pair : pairs) {
      auto& a = tree.sensor_from_root[pair.a];
      auto& b = tree.sensor_from_root[pair.b];
      if (!pair.a_from_b || a.has_value() == b.has_value()) continue;
      if (b) {
        a = *pair.a_from_b * *b;
      } else {
        b = pair.a_from_b->Inverse() * *a;
      }
      grown = true;
      break;
    }
  }
  for (std::size_t s = 0; s < problem.sensors.size(); ++s) {
    if (tree.sensor_from_root[s]) continue;
    tree.unconnected.push_back(WhatIsMissing(problem, pairs, tree, s));
  }
  return tree;
}

RigState StateOf(const RigProblem& problem, const RigModel& model,
                 const std::vector<Rigid3d>& sensor_from_root) {
  RigState state{.sensor_from_root = sensor_from_root,
                 .root_from_board = {},
                 .shifts = {},
                 .motions = {},
                 .numbers = std::vector<double>(model.numbers.size(), 0.0)};
  std::size_t first = 0;
  for (std::size_t i = 0; i < problem.placements.size(); ++i) {
    const RigPlacement& placement = problem.placements[i];
    std::size_t end = first;
    while (end < model.blocks.size() && model.blocks[end].placement == i) ++end;
    const std::span<const RigBlock> blocks(model.blocks.data() + first, end - first);
    first = end;
    const PlaceOfBoard start =
        BoardStart(problem, placement, model.placements[i].moves, blocks, state).Best();
    state.root_from_board.push_back(start.root_from_board);
    state.motions.push_back(start.motion);
    state.shifts.emplace_back(model.placements[i].shifts.size());
  }
  return state;
}

}  // namespace sextant
