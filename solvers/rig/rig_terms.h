// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "solvers/core/rig_problem.h"
#include "solvers/joint/board_view_residuals.h"
#include "solvers/rig/rig_model.h"

namespace sextant {

// The residuals of each kind of measurement as functions of sensor_from_board. Each holds its own
// copy of what it needs, shared between copies of the function.

using RigResidualFunction = decltype(RigBlock::residuals);

RigResidualFunction PrintedResiduals(PrintedTerm term, std::shared_ptr<const Camera> camera);

RigResidualFunction FaceResiduals(std::vector<FaceTerm> terms);

RigResidualFunction EdgeResiduals(std::vector<EdgeTerm> terms);

/// (measured - R p - t) / sigma, three of each point.
RigResidualFunction PointResiduals(std::vector<MeasuredPoint> points);

/// With n the normal and the pose (R, t): n.(R x) / sigma_rad, n.(R y) / sigma_rad and
/// (distance - n.t) / sigma_m.
RigResidualFunction PlaneResiduals(const MeasuredPlane& plane);

/// The distances of both ends of each side from its measured line, along two axes across the line,
/// over sigma: four of each line.
RigResidualFunction LineResiduals(const std::vector<MeasuredLine>& lines, const Board& board);

/// The ends of a side in the board frame.
std::array<Eigen::Vector3d, 2> EndsOf(const Board& board, int side);

}  // namespace sextant
