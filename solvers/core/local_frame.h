// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "geometry/calibration_problem.h"
#include "solvers/core/solver.h"

namespace sextant {

/// Coordinates about the centre of the data, in a unit of their extent, in which a solver works
/// where those of the problem would cost it digits: doubles resolve 2e-9 m at a distance of 1e7 m,
/// and sums of squares half of that. With o the centre of the LiDAR points, c that of the camera
/// points and s the unit, local coordinates are (p - o) / s and (q - c) / s.
class LocalFrame {
 public:
  /// The frame for the data that `needs` names; none where the coordinates are good as they are:
  /// nearer to the origin than 100 times their extent, and, for pixels alone, of an extent between
  /// 1 cm and 1 km. The scale is a power of two, and 1 where distances from the camera are
  /// measured. Raw board views are never moved: their rays begin at the LiDAR. Costs a few
  /// operations for ordinary data, else a pass over the points.
  static std::optional<LocalFrame> For(const CalibrationProblem& problem, const DataNeeds& needs);

  /// The problem in local coordinates.
  CalibrationProblem Localised(const CalibrationProblem& problem) const;

  /// The answer to Localised(problem) in the coordinates of `problem`: poses, and the covariance of
  /// (dphi, dt), where dt gains the turn dphi acting on the distance of the origin. A warning then
  /// gives the sigma at the centre of the points.
  void Restore(Estimate& estimate) const;

 private:
  Rigid3d Restored(const Rigid3d& local) const;

  Eigen::Vector3d lidar_centre_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d cam_centre_ = Eigen::Vector3d::Zero();
  double unit_m_ = 1.0;
  bool is_far_ = false;  ///< So far that the sigma of the translation means little.
};

}  // namespace sextant
