// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "base/error.h"
#include "geometry/calibration_problem.h"
#include "solvers/joint/board_view_residuals.h"
#include "solvers/joint/joint_options.h"

namespace sextant {

/// Numbers that all views share besides cam_from_lidar, with independent normal priors: one
/// parameter block. A number that the views do not determine stays at its prior.
struct SharedBlock {
  std::vector<std::string> names;  ///< As in EstimatedNumber.
  Eigen::VectorXd mean;
  Eigen::VectorXd sigma;
  bool reported = true;
  bool is_ring =
      false;  ///< The offset of one ring, whose sigma is multiplied by JointNoise::rings.
};

/// Returns from a face to whose ranges the same shared blocks of one number add.
struct FaceGroup {
  std::vector<std::size_t> members;  ///< Indices into BoardViewTerms::face.
  std::vector<std::size_t> shared;
  Eigen::MatrixXd by;  ///< One row for each member, one column for each block [m per unit].
};

/// The distance by which a shared block moves each side outwards, as the LiDAR sees it.
struct EdgeShift {
  std::size_t shared = 0;
  Eigen::MatrixXd by;  ///< One row for each edge [m per unit].
};

/// One BoardView prepared for the model.
struct JointView {
  BoardViewTerms terms;
  std::vector<FaceGroup> face;
  std::vector<EdgeShift> shifts;
  double lever_m = 0.0;  ///< Half the board's mean side.
};

/// What is estimated besides the poses.
struct JointModel {
  std::vector<SharedBlock> shared;
  std::vector<JointView> views;
  Camera camera;
  std::vector<int> intrinsics;  ///< Ascending indices into IntrinsicsOf; the last shared block.

  /// `camera` with the intrinsics of that block.
  Camera CameraWith(const Eigen::Ref<const Eigen::VectorXd>& numbers) const;
};

/// The LiDAR's errors by problem.lidar_errors, and what the options free. Errors: those of
/// FreeIntrinsics.
Expected<JointModel> ModelOf(const CalibrationProblem& problem, const JointOptions& options);

/// The poses of a board in both sensors. They differ from cam_from_lidar by what shifts all returns
/// of one view together (LidarErrorModel::view_shift_sigma_m).
struct BoardPoses {
  Rigid3d cam_from_board;
  Rigid3d lidar_from_board;
};

struct JointState {
  Rigid3d cam_from_lidar;
  std::vector<BoardPoses> boards;       ///< One per view.
  std::vector<Eigen::VectorXd> shared;  ///< One per shared block.
};

/// (rotation times lever, translation) [m] in the board frame from the pose that the camera
/// predicts to that of the LiDAR: x and y of the rotation and z of the translation move the returns
/// out of the plane, the others within it.
Vector6d LinkError(const JointState& state, std::size_t view, double lever_m);
inline constexpr bool kLinkIsOutOfPlane[6] = {true, true, false, false, false, true};

/// Whitened residuals of a view's observations at a state, infinite where there is none.
BoardViewResiduals ResidualsAt(const JointModel& model, const JointState& state, std::size_t view);

}  // namespace sextant
