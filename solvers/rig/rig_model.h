// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "geometry/rigid3d.h"
#include "solvers/core/rig_problem.h"
#include "solvers/rig/rig_motion.h"

namespace sextant {

/// Kinds of residuals; the noise level of each is estimated for each sensor.
enum class RigKind { kPrinted, kFace, kEdges, kPoints, kPlane, kLines, kShiftOut, kShiftIn };
inline constexpr std::size_t kRigKinds = 8;

/// Whitened residuals of a sensor's measurements, with their derivative by (dphi, dt) of
/// sensor_from_board.
struct RigResiduals {
  Eigen::VectorXd value;
  Eigen::Matrix<double, Eigen::Dynamic, 6> by_pose;
};

/// A number of one sensor that all of its observations share, with a normal prior of mean 0. One
/// that the data does not determine stays at its prior.
struct RigNumber {
  std::size_t sensor = 0;
  std::string name{};
  double sigma = 0.0;
  bool reported = true;
};

/// Adds `by` (one entry a residual) times a shared number to the residuals of a block.
struct RigNumberUse {
  std::size_t number = 0;  ///< Index into RigModel::numbers.
  Eigen::VectorXd by;
};

/// Residuals of one kind and one observation that depend on the same parameters. A unit is what is
/// used or left out as a whole: a print with all of its points, one return, one measured point.
struct RigBlock {
  RigKind kind = RigKind::kPrinted;
  std::size_t placement = 0;
  std::size_t seen = 0;  ///< Index into RigPlacement::seen.
  std::size_t sensor = 0;
  int rows_per_unit = 1;
  int units = 0;
  double time_s = 0.0;  ///< By the sensor's clock, after the placement's time.
  /// The sensor's time offset, an index into RigModel::numbers: how far its clock is ahead of the
  /// root's. None where it is not estimated.
  std::optional<std::size_t> clock{};
  /// False where there are none at that pose: a point does not project, a ray misses the plane.
  std::function<bool(const Rigid3d& sensor_from_board, RigResiduals& out)> residuals{};
  std::vector<RigNumberUse> numbers{};

  int rows() const { return rows_per_unit * units; }
};

/// What shifts all returns of one observation together (LidarErrorModel::view_shift_sigma_m): a
/// pose near the identity between the board and its appearance in that scan. The residuals of its
/// prior are (rotation times lever, translation) over the sigmas.
struct RigShift {
  std::size_t seen = 0;
  std::size_t sensor = 0;
  double lever_m = 0.0;  ///< Half the board's mean side.
  double sigma_m = 0.0;
};
/// Where the sensor has no such shift: so small that it changes no answer.
inline constexpr double kMinShift_m = 1e-6;
/// While it is decided which views contradict the others, shifts are at least of this level.
inline constexpr double kDecisionShift_m = 1e-4;
inline constexpr std::array<bool, 6> kShiftIsOutOfPlane = {true, true, false, false, false, true};

/// A placement prepared for estimation.
struct RigPlacementModel {
  std::vector<RigShift> shifts;
  std::vector<int> shift_of;  ///< For each observation the index into `shifts`, or -1.
  bool moves = false;         ///< Whether its board has a motion.

  /// The poses of its parameter block: the board, the shifts, and the motion.
  int poses() const { return 1 + static_cast<int>(shifts.size()) + (moves ? 2 : 0); }
  int first_of_motion() const { return 1 + static_cast<int>(shifts.size()); }
};

struct RigModel {
  std::size_t sensors = 0;
  std::vector<RigNumber> numbers;
  std::vector<RigPlacementModel> placements;
  std::vector<RigBlock> blocks;  ///< By placement, in ascending order.
};

/// RigNumber::name of a time offset, and the standard deviation of its prior.
inline constexpr const char* kTimeOffset = "time_offset_s";
inline constexpr double kClockSigma_s = 0.1;

/// Requires a problem that passes CheckRigProblem, with sensor_from_board of every observation that
/// has edge rays. The model refers to nothing of the problem.
/// `clock_root`: where the time offsets of the sensors are estimated, the one whose clock counts.
RigModel RigModelOf(const RigProblem& problem, std::optional<std::size_t> clock_root = {});

/// Poses relative to the root's frame.
struct RigState {
  std::vector<Rigid3d> sensor_from_root;
  std::vector<Rigid3d> root_from_board;      ///< One for each placement.
  std::vector<std::vector<Rigid3d>> shifts;  ///< board_from_seen for RigPlacementModel::shifts.
  std::vector<RigMotion> motions;            ///< One for each placement; at rest unless it moves.
  std::vector<double> numbers;
};

/// The pose at which the residuals of a block are those of a state.
Rigid3d SensorFromBoardOf(const RigModel& model, const RigState& state, const RigBlock& block);
/// The time of a block after that of its placement.
double TimeOf(const RigState& state, const RigBlock& block);

}  // namespace sextant
