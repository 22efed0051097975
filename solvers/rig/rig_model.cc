// SPDX-License-Identifier: Apache-2.0
#include "solvers/rig/rig_model.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "solvers/core/board_view_check.h"
#include "solvers/joint/board_view_residuals.h"
#include "solvers/rig/rig_terms.h"

namespace sextant {
namespace {

/// The numbers that one LiDAR's observations share.
struct SharedOf {
  std::optional<std::size_t> clock;
  std::optional<std::size_t> range;
  std::optional<std::size_t> growth_along;  ///< The next one is that across.
  std::map<int, std::size_t> rings;
};

class RigModelMaker {
 public:
  RigModelMaker(const RigProblem& problem, std::optional<std::size_t> clock_root)
      : problem_(problem), clock_root_(clock_root) {
    model_.sensors = problem.sensors.size();
    shared_.resize(model_.sensors);
    for (const RigSensor& sensor : problem.sensors) {
      cameras_.push_back(sensor.camera ? std::make_shared<const Camera>(*sensor.camera) : nullptr);
    }
  }

  RigModel Make() {
    for (std::size_t i = 0; i < problem_.placements.size(); ++i) {
      model_.placements.emplace_back();
      SetTime(problem_.placements[i]);
      for (std::size_t k = 0; k < problem_.placements[i].seen.size(); ++k) AddObservation(i, k);
    }
    return std::move(model_);
  }

 private:
  // A placement's time is the middle of its observations, where its pose is known best.
  void SetTime(const RigPlacement& placement) {
    constexpr double kSameTime_s = 1e-6;
    double first = std::numeric_limits<double>::infinity();
    double last = -first;
    for (const RigObservation& seen : placement.seen) {
      if (!seen.time_s) continue;
      first = std::min(first, *seen.time_s);
      last = std::max(last, *seen.time_s);
    }
    const bool timed = last >= first;
    time_s_ = timed ? 0.5 * (first + last) : 0.0;
    model_.placements.back().moves = timed && (clock_root_ || last - first > kSameTime_s);
  }

  void AddClock(const RigObservation& of, RigBlock& block) {
    if (!of.time_s || !model_.placements.back().moves) return;
    block.time_s = *of.time_s - time_s_;
    if (!clock_root_ || of.sensor == *clock_root_) return;
    std::optional<std::size_t>& clock = shared_[of.sensor].clock;
    if (!clock) clock = AddNumber(of.sensor, kTimeOffset, kClockSigma_s, true);
    block.clock = clock;
  }

  // The raw observations with the pose by which edge rays are assigned to points of a rim.
  static BoardView WithPose(const RigObservation& of) {
    BoardView view = of.raw;
    if (of.sensor_from_board) view.lidar_from_board = *of.sensor_from_board;
    return view;
  }

  void AddObservation(std::size_t placement, std::size_t seen) {
    const RigObservation& of = problem_.placements[placement].seen[seen];
    const Board& board = *FindBoard(problem_.boards, problem_.placements[placement].board);
    BoardViewTerms terms = TermsOf(WithPose(of), board);
    RigBlock block{.placement = placement, .seen = seen, .sensor = of.sensor};
    AddClock(of, block);
    for (PrintedTerm& term : terms.printed) {
      const int rows = 2 * static_cast<int>(term.pixels.size());
      Add(block, RigKind::kPrinted, 1, rows,
          PrintedResiduals(std::move(term), cameras_[of.sensor]));
    }
    AddShift(of, board, seen);
    AddFace(block, of, terms.face);
    AddEdges(block, of, terms.edges);
    if (!of.points.empty()) {
      Add(block, RigKind::kPoints, std::ssize(of.points), 3, PointResiduals(of.points));
    }
    if (of.plane) Add(block, RigKind::kPlane, 1, 3, PlaneResiduals(*of.plane));
    if (!of.lines.empty()) {
      Add(block, RigKind::kLines, std::ssize(of.lines), 4, LineResiduals(of.lines, board));
    }
  }

  void Add(RigBlock block, RigKind kind, std::ptrdiff_t units, int rows_per_unit,
           RigResidualFunction residuals) {
    block.kind = kind;
    block.units = static_cast<int>(units);
    block.rows_per_unit = rows_per_unit;
    block.residuals = std::move(residuals);
    model_.blocks.push_back(std::move(block));
  }

  void AddShift(const RigObservation& of, const Board& board, std::size_t seen) {
    RigPlacementModel& placement = model_.placements.back();
    const bool has_returns = !of.raw.face_in_lidar.empty() || !of.raw.edges.empty();
    placement.shift_of.push_back(has_returns ? static_cast<int>(placement.shifts.size()) : -1);
    if (!has_returns) return;
    const double sigma = problem_.sensors[of.sensor].lidar_errors.view_shift_sigma_m;
    placement.shifts.push_back({.seen = seen,
                                .sensor = of.sensor,
                                .lever_m = 0.25 * (board.top_right_m + board.right_bottom_m),
                                .sigma_m = std::max(sigma, kMinShift_m)});
  }

  std::size_t AddNumber(std::size_t sensor, std::string name, double sigma, bool reported) {
    model_.numbers.push_back({sensor, std::move(name), sigma, reported});
    return model_.numbers.size() - 1;
  }

  std::size_t RingNumber(std::size_t sensor, int ring) {
    auto& rings = shared_[sensor].rings;
    const auto at = rings.find(ring);
    if (at != rings.end()) return at->second;
    const double sigma = problem_.sensors[sensor].lidar_errors.ring_offset_sigma_m;
    return rings[ring] = AddNumber(sensor, fmt::format("ring_{}_offset_m", ring), sigma, false);
  }

  // One block for each ring, as the returns of a ring share an offset.
  void AddFace(const RigBlock& block, const RigObservation& of, const std::vector<FaceTerm>& face) {
    const LidarErrorModel& errors = problem_.sensors[of.sensor].lidar_errors;
    const bool by_ring = !of.raw.face_rings.empty() && errors.ring_offset_sigma_m > 0.0;
    std::map<int, std::vector<FaceTerm>> groups;
    for (std::size_t k = 0; k < face.size(); ++k) {
      groups[by_ring ? of.raw.face_rings[k] : -1].push_back(face[k]);
    }
    std::optional<std::size_t>& range = shared_[of.sensor].range;
    if (!range && !face.empty() && errors.range_offset_sigma_m > 0.0) {
      range = AddNumber(of.sensor, "range_bias_m", errors.range_offset_sigma_m, true);
    }
    for (auto& [ring, terms] : groups) {
      const std::ptrdiff_t count = std::ssize(terms);
      Eigen::VectorXd by(count);
      for (std::size_t k = 0; k < terms.size(); ++k) {
        by[static_cast<Eigen::Index>(k)] = -terms[k].inverse_sigma;
      }
      Add(block, RigKind::kFace, count, 1, FaceResiduals(std::move(terms)));
      auto& numbers = model_.blocks.back().numbers;
      if (range) numbers.push_back({*range, by});
      if (ring >= 0) numbers.push_back({RingNumber(of.sensor, ring), by});
    }
  }

  // An outline appears too large, along the scan direction and across it.
  void AddEdges(const RigBlock& block, const RigObservation& of,
                const std::vector<EdgeTerm>& edges) {
    if (edges.empty()) return;
    Add(block, RigKind::kEdges, std::ssize(edges), 1, EdgeResiduals(edges));
    const double sigma = problem_.sensors[of.sensor].lidar_errors.edge_growth_sigma_m;
    if (!(sigma > 0.0)) return;
    std::optional<std::size_t>& first = shared_[of.sensor].growth_along;
    if (!first) {
      first = AddNumber(of.sensor, "edge_growth_along_m", sigma, true);
      AddNumber(of.sensor, "edge_growth_across_m", sigma, true);
    }
    const Eigen::Matrix3d axes = of.sensor_from_board->rotation.toRotationMatrix();
    Eigen::VectorXd by_along(std::ssize(edges));
    Eigen::VectorXd by_across(std::ssize(edges));
    for (std::size_t k = 0; k < edges.size(); ++k) {
      const EdgeTerm& edge = edges[k];
      const Eigen::Vector3d outward = axes.leftCols<2>() * edge.side.outward;
      const Eigen::Vector3d along = Eigen::Vector3d::UnitZ().cross(edge.direction).normalized();
      const Eigen::Vector3d across = edge.direction.cross(along);
      const auto row = static_cast<Eigen::Index>(k);
      by_along[row] = edge.inverse_sigma * std::abs(outward.dot(along));
      by_across[row] = edge.inverse_sigma * std::abs(outward.dot(across));
    }
    model_.blocks.back().numbers = {{*first, by_along}, {*first + 1, by_across}};
  }

  const RigProblem& problem_;
  std::optional<std::size_t> clock_root_;
  double time_s_ = 0.0;  ///< The current placement's.
  std::vector<std::shared_ptr<const Camera>> cameras_;
  std::vector<SharedOf> shared_;
  RigModel model_;
};

}  // namespace

RigModel RigModelOf(const RigProblem& problem, std::optional<std::size_t> clock_root) {
  return RigModelMaker(problem, clock_root).Make();
}

double TimeOf(const RigState& state, const RigBlock& block) {
  return block.time_s - (block.clock ? state.numbers[*block.clock] : 0.0);
}

Rigid3d SensorFromBoardOf(const RigModel& model, const RigState& state, const RigBlock& block) {
  const RigPlacementModel& placement = model.placements[block.placement];
  Rigid3d pose = state.sensor_from_root[block.sensor] * state.root_from_board[block.placement];
  if (placement.moves) {
    pose = pose * MovedAfter(state.motions[block.placement], TimeOf(state, block)).board_from_moved;
  }
  const int shift = placement.shift_of[block.seen];
  const bool returns = block.kind == RigKind::kFace || block.kind == RigKind::kEdges;
  if (shift < 0 || !returns) return pose;
  return pose * state.shifts[block.placement][static_cast<std::size_t>(shift)];
}

}  // namespace sextant
