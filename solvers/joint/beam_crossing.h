// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "geometry/calibration_problem.h"
#include "solvers/joint/board_view_residuals.h"

namespace sextant {

/// The beams of a turning LiDAR cross at its lens, a few centimetres before the axis (42 mm in a
/// VLP-16): that of elevation e starts at the height -d tan(e) on the axis. Many drivers write the
/// returns as if all beams started at the origin, each too high by -d tan(e), so that a board looks
/// d / range too tall and tilted. `d`, the crossing distance, is then one unknown of the sensor;
/// the terms below are linear in it, at the poses of the boards by the scans.

/// Whether the returns lie on rays from the origin: each ring of the face returns has one elevation
/// at every range, to 0.01 deg. False without ring numbers. O(returns).
bool BeamsStartAtOrigin(const CalibrationProblem& problem);

/// The excess of each face return's range per unit of d: tan(e) n_z / (n . u), n the board's normal
/// and u the ray.
Eigen::VectorXd RangeByCrossing(const BoardViewTerms& terms, const BoardPlane& plane);

/// How much farther out each edge ray meets the plane per unit of d:
/// tan(e) a . (z - u n_z / (n . u)), a the outward direction of its side.
Eigen::VectorXd OutwardByCrossing(const BoardViewTerms& terms, const BoardPlane& plane);

}  // namespace sextant
