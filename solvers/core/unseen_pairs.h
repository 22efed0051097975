// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "geometry/calibration_problem.h"

namespace sextant {

/// Indices of the 2D-3D pairs whose pixel is the image of a ray: those of pixels outside the
/// camera model's domain, such as beyond a pole of its distortion, belong to no point. Requires a
/// camera.
std::vector<int> PairsWithRay(const CalibrationProblem& problem);

/// A sentence for each 2D-3D pair that has no residual at the pose, with its number and the reason:
/// its pixel has no ray, or its point does not project. At most five, then their number.
std::vector<std::string> NotesOnUnseenPairs(const CalibrationProblem& problem, const Camera& camera,
                                            const Rigid3d& cam_from_lidar);

}  // namespace sextant
