// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/calibration_problem.h"
#include "solvers/joint/joint_model.h"

namespace sextant {

/// Where the search starts: the shared numbers at their priors, and each sensor's own pose of a
/// board, or the LiDAR's for both where that fits the image better than the two agree.
JointState StartAt(const CalibrationProblem& problem, const JointModel& model,
                   const Rigid3d& cam_from_lidar);

}  // namespace sextant
