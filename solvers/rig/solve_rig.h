// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/progress.h"
#include "geometry/uncertain_pose.h"
#include "solvers/core/rig_problem.h"
#include "solvers/rig/rig_model.h"

namespace sextant {

struct RigOptions {
  std::size_t root = 0;  ///< The sensor whose frame the boards' poses are in.
  /// Observations beyond this many sigmas of the estimated noise are left out.
  double cut = 4.0;
  int max_iterations = 100;
  double step_tolerance = 1e-10;
  /// Estimates how far the clock of each sensor with times is ahead of the root's
  /// (RigObservation::time_s), as the number time_offset_s; not where the boards' motion is lost in
  /// the noise, which a warning states.
  bool estimate_time = false;
  bool boards_move = false;     ///< It is known that they do, so estimate_time does not test it.
  ProgressCallback progress{};  ///< Stage "rig": minima, at most as many as are announced.
};

/// What became of one observation.
struct RigObservationFit {
  std::size_t placement = 0;  ///< Index into RigProblem::placements.
  std::size_t sensor = 0;     ///< Index into RigProblem::sensors.
  bool used = false;
  int units = 0;  ///< Prints, returns, edge rays, points, planes and lines in use.
  int of = 0;
  double rms = 0.0;  ///< The whitened residuals in use, at their stated noise.
};

/// A number that a sensor's observations share, such as a constant range error.
struct RigEstimatedNumber {
  std::size_t sensor = 0;
  std::string name{};
  double value = 0.0;
  double sigma = 0.0;
};

/// The estimated noise of one kind of observation of a sensor, over the stated one.
struct RigNoiseLevel {
  std::size_t sensor = 0;
  RigKind kind = RigKind::kPrinted;
  double level = 1.0;
};

/// "printed corners", "returns" and so on, for people.
std::string_view NameOf(RigKind kind);

/// The poses of all connected sensors, with everything that was estimated with them.
struct RigEstimate {
  std::size_t root = 0;
  /// None for a sensor that no view connects with the root.
  std::vector<std::optional<Rigid3d>> sensor_from_root{};
  std::vector<std::string> unconnected{};  ///< For each of these, what would connect it.
  /// For (dphi, dt) of sensor_from_root of the connected sensors but the root, in their order.
  Eigen::MatrixXd covariance{};
  std::vector<RigObservationFit> fits{};  ///< By placement; only placements with two sensors.
  std::vector<RigEstimatedNumber> numbers{};
  std::vector<RigNoiseLevel> noise{};
  std::vector<std::string> warnings{};
  /// Why the poses may be wrong by more than their covariance states: sentences; usually none.
  std::vector<std::string> refutations{};
  int iterations = 0;

  /// a_from_b with the covariance of its (dphi, dt). Requires that both sensors are connected.
  UncertainPose Between(std::size_t a, std::size_t b) const;
};

/// argmin of 1/2 sum |r|^2 over the poses of all sensors and of all boards, r the whitened
/// residuals of what every sensor measured of every board. One camera and one LiDAR are the case of
/// two sensors; cameras alone and LiDARs alone are cases, too.
///
/// Start: pairs of sensors by the boards that both see, then the tree of the best observed pairs
/// (TreeOf). Then as SearchJointly (solvers/joint): least squares with Cauchy's loss, then
/// alternately least squares, the estimate of the noise of each sensor and kind of observation, and
/// the selection of the observations within `cut` of it. A LiDAR's systematic errors
/// (RigSensor::lidar_errors) are estimated along with the poses; a number that the data does not
/// determine stays at its prior.
///
/// Where observations have times, a board moves with constant velocity about the middle of its
/// moment, with priors on velocity and acceleration (rig_motion.h); both are eliminated with its
/// pose. What moved is data for the poses, and for time offsets.
///
/// Sensors that are not connected with the root are left out and named in `unconnected`. Time and
/// memory are linear in the placements, and quadratic in the numbers that all of them share.
/// Errors: those of CheckRigProblem; kMissingData where no sensor is connected with the root;
/// kDegenerate where the views leave a direction undetermined; kNoConvergence.
Expected<RigEstimate> SolveRig(const RigProblem& problem, const RigOptions& options = {});

/// The covariance that the stated noise allows at these poses, in the form of
/// RigEstimate::covariance: the Cramer-Rao bound at the true ones. `root_from_board`: one for each
/// placement. Errors: kDegenerate.
Expected<Eigen::MatrixXd> RigBound(const RigProblem& problem, std::size_t root,
                                   const std::vector<Rigid3d>& sensor_from_root,
                                   const std::vector<Rigid3d>& root_from_board);

/// The problem with these sensors alone, in this order, and the placements that at least two of
/// them see.
RigProblem Restricted(const RigProblem& problem, std::span<const std::size_t> sensors);

}  // namespace sextant
