// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/joint_model.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "geometry/intrinsics.h"
#include "solvers/core/board_view_check.h"
#include "solvers/joint/beam_crossing.h"
#include "solvers/joint/board_bend.h"
#include "solvers/refine/refine_camera.h"

namespace sextant {
namespace {

constexpr double kFreeOffset_m = 0.1;  // Prior of a range bias that an option frees.
// Prior of the distance at which the beams cross, 30 mm for a sensor about which nothing is known.
constexpr double kCrossingOverRing = 3.0;
constexpr double kRimGrowth_m = 0.02;  // Prior of what a hole appears too small.
constexpr double kFreeShare = 0.05;    // Prior of sizes and intrinsics, in shares of them.

// Largest shift of a printed point's pixel by one unit of an intrinsic.
double LeverOf(const CalibrationProblem& problem, int intrinsic) {
  if (intrinsic < kFirstDistortion) return 1.0;
  double lever = 0.0;
  for (const BoardView& view : problem.board_views) {
    for (const BoardPoints& printed : view.printed) {
      for (const Eigen::Vector2d& point : printed.in_board_m) {
        const auto by = PixelByIntrinsics(
            *problem.camera, view.cam_from_board * Eigen::Vector3d(point.x(), point.y(), 0.0));
        if (by) lever = std::max(lever, by->col(intrinsic).norm());
      }
    }
  }
  return lever;
}

/// Adds the shared blocks, and what they do to each view's observations.
class ModelMaker {
 public:
  ModelMaker(const CalibrationProblem& problem, const JointOptions& options)
      : problem_(problem), options_(options) {
    model_.camera = *problem.camera;
    for (const BoardView& view : problem.board_views) {
      const Board& board = *FindBoard(problem.boards, view.board);
      model_.views.push_back({.terms = TermsOf(view, board),
                              .face = {},
                              .shifts = {},
                              .lever_m = 0.25 * (board.top_right_m + board.right_bottom_m)});
    }
  }

  Expected<JointModel> Make() {
    AddRanges();
    AddCrossing();
    AddBends();
    AddGrowth();
    AddRimGrowth();
    if (options_.board_size == JointBoardSize::kScale) AddScale();
    if (options_.board_size == JointBoardSize::kSides) AddSides();
    SEXTANT_RETURN_IF_ERROR(AddIntrinsics());
    return std::move(model_);
  }

 private:
  std::size_t Add(std::vector<std::string> names, const Eigen::VectorXd& mean,
                  const Eigen::VectorXd& sigma, bool reported = true) {
    model_.shared.push_back({std::move(names), mean, sigma, reported});
    return model_.shared.size() - 1;
  }

  std::size_t AddOffset(std::string name, double sigma_m, bool reported) {
    return Add({std::move(name)}, Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, sigma_m),
               reported);
  }

  void AddRanges() {
    const double common =
        options_.range_bias ? kFreeOffset_m : problem_.lidar_errors.range_offset_sigma_m;
    std::optional<std::size_t> everywhere;
    if (common > 0.0) everywhere = AddOffset("range_bias_m", common, true);
    std::map<int, std::size_t> rings;
    for (std::size_t i = 0; i < model_.views.size(); ++i) {
      std::map<int, FaceGroup> groups;
      for (std::size_t k = 0; k < model_.views[i].terms.face.size(); ++k) {
        groups[RingOf(problem_.board_views[i], k)].members.push_back(k);
      }
      for (auto& [ring, group] : groups) {
        if (everywhere) group.shared.push_back(*everywhere);
        if (ring >= 0) group.shared.push_back(OffsetOf(ring, rings));
        group.by.setOnes(std::ssize(group.members), std::ssize(group.shared));
        model_.views[i].face.push_back(std::move(group));
      }
    }
  }

  // The crossing distance moves the ranges and the outlines.
  void AddCrossing() {
    const double sigma = kCrossingOverRing * problem_.lidar_errors.ring_offset_sigma_m;
    if (!(sigma > 0.0) || !BeamsStartAtOrigin(problem_)) return;
    const std::size_t shared = AddOffset("beam_crossing_m", sigma, true);
    for (std::size_t i = 0; i < model_.views.size(); ++i) {
      JointView& view = model_.views[i];
      const BoardPlane plane(problem_.board_views[i].lidar_from_board);
      AddToRanges(shared, RangeByCrossing(view.terms, plane), view);
      view.shifts.push_back({shared, OutwardByCrossing(view.terms, plane)});
    }
  }

  // Each board may bend; otherwise its bend would determine a common range offset. Where rings have
  // offsets, these are as large.
  void AddBends() {
    const double sigma_m = kBendOverRange * problem_.lidar_errors.range_offset_sigma_m;
    if (!(sigma_m > 0.0)) return;
    std::map<int, std::size_t> first_of_board;
    for (std::size_t i = 0; i < model_.views.size(); ++i) {
      JointView& view = model_.views[i];
      const BoardView& seen = problem_.board_views[i];
      if (view.terms.face.empty() || RingOf(seen, 0) >= 0) continue;
      const Board& board = *FindBoard(problem_.boards, seen.board);
      const auto [first, is_new] = first_of_board.try_emplace(board.id, model_.shared.size());
      for (Eigen::Index k = 0; is_new && k < kBends; ++k) {
        AddOffset(fmt::format("board_{}_{}", board.id, kBendNames[k]), sigma_m, false);
      }
      const double half_diagonal_m = 0.5 * std::hypot(board.top_right_m, board.right_bottom_m);
      const auto by = RangeByBend(view.terms, BoardPlane(seen.lidar_from_board), half_diagonal_m);
      for (Eigen::Index k = 0; k < kBends; ++k) {
        AddToRanges(first->second + static_cast<std::size_t>(k), by.col(k), view);
      }
    }
  }

  // A shared number that adds to the range of each face return of a view.
  static void AddToRanges(std::size_t shared, const Eigen::VectorXd& by_range, JointView& view) {
    for (FaceGroup& group : view.face) {
      group.shared.push_back(shared);
      group.by.conservativeResize(Eigen::NoChange, group.by.cols() + 1);
      for (std::size_t k = 0; k < group.members.size(); ++k) {
        group.by(static_cast<Eigen::Index>(k), group.by.cols() - 1) =
            by_range[static_cast<Eigen::Index>(group.members[k])];
      }
    }
  }

  // -1 where rings have no offsets.
  int RingOf(const BoardView& view, std::size_t face) const {
    const bool known = !view.face_rings.empty() && problem_.lidar_errors.ring_offset_sigma_m > 0.0;
    return known ? view.face_rings[face] : -1;
  }

  std::size_t OffsetOf(int ring, std::map<int, std::size_t>& rings) {
    const auto at = rings.find(ring);
    if (at != rings.end()) return at->second;
    const double sigma = problem_.lidar_errors.ring_offset_sigma_m;
    rings[ring] = AddOffset(fmt::format("ring_{}_offset_m", ring), sigma, false);
    model_.shared.back().is_ring = true;
    return rings[ring];
  }

  // By the share of a side's outward direction along the scan, and across it.
  void AddGrowth() {
    const double sigma = problem_.lidar_errors.edge_growth_sigma_m;
    if (!(sigma > 0.0)) return;
    const std::size_t shared = Add({"edge_growth_along_m", "edge_growth_across_m"},
                                   Eigen::VectorXd::Zero(2), Eigen::VectorXd::Constant(2, sigma));
    for (std::size_t i = 0; i < model_.views.size(); ++i) {
      const auto& edges = model_.views[i].terms.edges;
      const Eigen::Matrix3d axes =
          problem_.board_views[i].lidar_from_board.rotation.toRotationMatrix();
      Eigen::MatrixXd by(edges.size(), 2);
      for (std::size_t k = 0; k < edges.size(); ++k) {
        const Eigen::Vector3d outward = axes.leftCols<2>() * edges[k].side.outward;
        const Eigen::Vector3d along =
            Eigen::Vector3d::UnitZ().cross(edges[k].direction).normalized();
        const Eigen::Vector3d across = edges[k].direction.cross(along);
        by.row(static_cast<Eigen::Index>(k)) << std::abs(outward.dot(along)),
            std::abs(outward.dot(across));
      }
      model_.views[i].shifts.push_back({shared, std::move(by)});
    }
  }

  // Growth of the rims of round holes, whose points are placed by their deviation from a circle of
  // free radius.
  void AddRimGrowth() {
    std::optional<std::size_t> shared;
    for (std::size_t i = 0; i < model_.views.size(); ++i) {
      const std::vector<EdgeRay>& edges = problem_.board_views[i].edges;
      Eigen::MatrixXd by(edges.size(), 1);
      for (std::size_t k = 0; k < edges.size(); ++k) {
        by(static_cast<Eigen::Index>(k), 0) = edges[k].side >= kFirstRim ? 1.0 : 0.0;
      }
      if (by.isZero()) continue;
      if (!shared) shared = AddOffset("rim_growth_m", kRimGrowth_m, true);
      model_.views[i].shifts.push_back({*shared, std::move(by)});
    }
  }

  void AddScale() {
    const std::size_t shared =
        Add({"board_scale"}, Eigen::VectorXd::Ones(1), Eigen::VectorXd::Constant(1, kFreeShare));
    for (JointView& view : model_.views) {
      Eigen::MatrixXd by(view.terms.edges.size(), 1);
      for (std::size_t k = 0; k < view.terms.edges.size(); ++k) {
        by(static_cast<Eigen::Index>(k), 0) = view.terms.edges[k].side.offset_m;
      }
      view.shifts.push_back({shared, std::move(by)});
    }
  }

  void AddSides() {
    std::map<int, std::size_t> of_board;
    for (std::size_t i = 0; i < model_.views.size(); ++i) {
      const Board& board = *FindBoard(problem_.boards, problem_.board_views[i].board);
      if (!of_board.contains(board.id)) {
        const Eigen::Vector2d size(board.top_right_m, board.right_bottom_m);
        of_board[board.id] = Add({fmt::format("board_{}_top_right_m", board.id),
                                  fmt::format("board_{}_right_bottom_m", board.id)},
                                 size, kFreeShare * size);
      }
      const auto& edges = model_.views[i].terms.edges;
      Eigen::MatrixXd by(edges.size(), 2);
      for (std::size_t k = 0; k < edges.size(); ++k) {
        by.row(static_cast<Eigen::Index>(k)) = edges[k].side.offset_by_size.transpose();
      }
      model_.views[i].shifts.push_back({of_board[board.id], std::move(by)});
    }
  }

  Expected<void> AddIntrinsics() {
    SEXTANT_ASSIGN_OR_RETURN(model_.intrinsics, FreeIntrinsics(model_.camera, options_.intrinsics));
    if (model_.intrinsics.empty()) return {};
    const auto count = static_cast<Eigen::Index>(model_.intrinsics.size());
    const IntrinsicVector numbers = IntrinsicsOf(model_.camera);
    std::vector<std::string> names;
    Eigen::VectorXd mean(count);
    Eigen::VectorXd sigma(count);
    for (const int index : model_.intrinsics) {
      const auto i = static_cast<Eigen::Index>(names.size());
      names.emplace_back(IntrinsicName(model_.camera.model, index));
      mean[i] = numbers[index];
      sigma[i] = kFreeShare * model_.camera.fx_px / std::max(LeverOf(problem_, index), 1e-12);
    }
    Add(std::move(names), mean, sigma);
    return {};
  }

  const CalibrationProblem& problem_;
  const JointOptions& options_;
  JointModel model_;
};

}  // namespace

Camera JointModel::CameraWith(const Eigen::Ref<const Eigen::VectorXd>& numbers) const {
  IntrinsicVector all = IntrinsicsOf(camera);
  for (std::size_t k = 0; k < intrinsics.size(); ++k) {
    all[intrinsics[k]] = numbers[static_cast<Eigen::Index>(k)];
  }
  return WithIntrinsics(camera, all);
}

Expected<JointModel> ModelOf(const CalibrationProblem& problem, const JointOptions& options) {
  return ModelMaker(problem, options).Make();
}

Vector6d LinkError(const JointState& state, std::size_t view, double lever_m) {
  const BoardPoses& board = state.boards[view];
  const Rigid3d error =
      board.cam_from_board.Inverse() * state.cam_from_lidar * board.lidar_from_board;
  Vector6d link;
  link << lever_m * LogSo3(error.rotation), error.translation;
  return link;
}

BoardViewResiduals ResidualsAt(const JointModel& model, const JointState& state, std::size_t i) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const JointView& view = model.views[i];
  BoardViewResiduals residuals;
  const Camera camera =
      model.intrinsics.empty() ? model.camera : model.CameraWith(state.shared.back());
  PrintedResidual printed;
  for (const PrintedTerm& term : view.terms.printed) {
    const bool seen = Differentiate(term, camera, state.boards[i].cam_from_board, printed);
    residuals.printed.push_back(
        seen ? printed.value.norm() / std::sqrt(static_cast<double>(printed.value.size())) : kNone);
  }
  const BoardPlane plane(state.boards[i].lidar_from_board);
  RayResidual ray;
  residuals.face.assign(view.terms.face.size(), kNone);
  for (const FaceGroup& group : view.face) {
    Eigen::VectorXd offset = Eigen::VectorXd::Zero(group.by.rows());
    for (Eigen::Index s = 0; s < group.by.cols(); ++s) {
      offset += group.by.col(s) * state.shared[group.shared[static_cast<std::size_t>(s)]][0];
    }
    for (std::size_t m = 0; m < group.members.size(); ++m) {
      const std::size_t k = group.members[m];
      const FaceTerm& term = view.terms.face[k];
      if (!Differentiate(term, plane, ray)) continue;
      residuals.face[k] = ray.value - term.inverse_sigma * offset[static_cast<Eigen::Index>(m)];
    }
  }
  Eigen::VectorXd shift = Eigen::VectorXd::Zero(std::ssize(view.terms.edges));
  for (const EdgeShift& by : view.shifts) {
    shift += by.by * (state.shared[by.shared] - model.shared[by.shared].mean);
  }
  for (std::size_t k = 0; k < view.terms.edges.size(); ++k) {
    const EdgeTerm& term = view.terms.edges[k];
    residuals.edges.push_back(Differentiate(term, plane, ray)
                                  ? ray.value +
                                        term.inverse_sigma * shift[static_cast<Eigen::Index>(k)]
                                  : kNone);
  }
  return residuals;
}

}  // namespace sextant
