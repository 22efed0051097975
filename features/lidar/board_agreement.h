// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "features/lidar/board_finder.h"
#include "features/lidar/plane_rays.h"

namespace sextant {

/// Compares a placed board with the rays around it. `rays`: at least those within its diagonal.
BoardAgreement AgreementOf(const ScanRings& scan, const PlaneRays& rays, const BoardPatch& patch,
                           const Board& board);

/// The same with the rays that it needs.
BoardAgreement AgreementOf(const ScanRings& scan, const BoardPatch& patch, const Board& board);

/// How badly a placement explains the rays: the number of those onto the board that pass through it
/// and of those beyond its outline that end in its plane, each weighted, less the number of returns
/// on it.
double RayCost(const PlaneRays& rays, const RectangleFit& fit, const Board& board);

/// Distance of a point in the plane beyond the placed board's nearest side; negative inside.
double BeyondBoard(const RectangleFit& fit, const Board& board, const Eigen::Vector2d& in_plane);

/// Why the patch is not this board; none if it is.
std::optional<std::string> RejectionReason(const BoardPatch& patch, const Board& board);

}  // namespace sextant
