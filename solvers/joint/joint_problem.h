// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "geometry/calibration_problem.h"
#include "geometry/intrinsics.h"
#include "solvers/joint/board_view_information.h"
#include "solvers/refine/refine_ceres.h"

namespace sextant {

enum class JointBoardSize { kGiven, kScale, kSides };

/// The parameters shared by all views, and their order: (dphi, dt) of cam_from_lidar, then the
/// range bias, then the size of the boards (one scale, or (top_right_m, right_bottom_m) of each
/// board), then intrinsics.
struct JointUnknowns {
  bool range_bias = false;
  JointBoardSize board_size = JointBoardSize::kGiven;
  std::vector<int> sized_boards;  ///< Ids of boards whose sides are estimated; with kSides only.
  std::vector<int> intrinsics;    ///< Ascending indices into IntrinsicsOf.

  int Bias() const { return 6; }
  int Size() const { return 6 + (range_bias ? 1 : 0); }
  int Intrinsic() const { return Size() + SizeCount(); }
  int SizeCount() const;
  int Count() const { return Intrinsic() + static_cast<int>(intrinsics.size()); }
};

/// A robust loss for each kind of observation. A BoardPoints of n points counts as one observation,
/// with its norm relative to the mean norm sqrt(2 n).
struct JointLosses {
  RobustLoss printed;
  RobustLoss face;
  RobustLoss edges;
};

/// The estimated parameters.
struct JointState {
  Rigid3d cam_from_lidar;
  std::vector<Rigid3d> cam_from_board;  ///< One per view.
  double range_bias_m = 0.0;            ///< Added by the LiDAR to every range.
  Eigen::VectorXd size;  ///< Change of sides [m], or of the scale; see JointUnknowns.
  Camera camera;
};

/// Normal equations of one view; `b` stands for its board's pose, `s` for the shared parameters.
struct JointViewSystem {
  Matrix6d bb = Matrix6d::Zero();
  Eigen::Matrix<double, 6, Eigen::Dynamic> bs;
  Vector6d b = Vector6d::Zero();  ///< Gradient.
};

struct JointSystem {
  std::vector<JointViewSystem> views;
  Eigen::MatrixXd ss;
  Eigen::VectorXd s;  ///< Gradient.
  double cost = 0.0;  ///< 1/2 sum rho
};

/// One view prepared for a set of unknowns.
struct JointView {
  BoardViewTerms terms;
  int sized_board = -1;  ///< Index into JointUnknowns::sized_boards; -1: none.
};

// Range bias, then size along x and y, or the scale.
inline constexpr int kLidarExtras = 3;

struct JointRay {
  RayResidual residual;
  Eigen::Matrix<double, 1, kLidarExtras> by_extras;
};

/// The residual of a ray, with derivatives by the LiDAR's bias and the board's size.
class JointRayModel {
 public:
  JointRayModel(const JointView& view, const JointUnknowns& unknowns, const JointState& state)
      : view_(view), unknowns_(unknowns), state_(state) {}

  /// False where the ray does not intersect the plane.
  bool Differentiate(const FaceTerm& term, const BoardPlane& plane, JointRay& out) const;
  bool Differentiate(const EdgeTerm& term, const BoardPlane& plane, JointRay& out) const;

  /// Index of an extra parameter among the shared unknowns; -1 where it is not estimated.
  int IndexOf(int lidar_extra) const;

 private:
  const JointView& view_;
  const JointUnknowns& unknowns_;
  const JointState& state_;
};

/// rho(s) and its slope for s = |r|^2; kNone, kHuber and kCauchy.
struct LossValue {
  double rho = 0.0;
  double slope = 1.0;
};
LossValue ApplyLoss(LossKind kind, double scale, double squared);

/// Upper limit of the norm of a BoardPoints at `sigmas`: the norm of 2n whitened normal variables
/// has mean sqrt(2n) and a standard deviation of 1/sqrt(2) (Fisher 1922).
double PrintedLimit(std::size_t points, double sigmas);

/// Normal equations and cost at `state`, with weights rho' (iteratively reweighted least squares).
/// None where a residual is undefined.
std::optional<JointSystem> Linearise(const std::vector<JointView>& views,
                                     const JointUnknowns& unknowns, const JointLosses& losses,
                                     const JointState& state);

/// The state moved by a step of the shared unknowns and one of each view's board.
JointState Moved(const JointState& state, const JointUnknowns& unknowns,
                 const Eigen::VectorXd& shared, const std::vector<Vector6d>& boards);

}  // namespace sextant
