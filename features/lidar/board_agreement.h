// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "features/lidar/board_finder.h"

namespace sextant {

/// Compares the placed board with every ray onto it and around it.
BoardAgreement AgreementOf(const ScanRings& scan, const BoardPatch& patch, const Board& board);

/// Distance of a point in the plane beyond the placed board's nearest side; negative inside.
double BeyondBoard(const BoardPatch& patch, const Board& board, const Eigen::Vector2d& in_plane);

/// Why the patch is not this board; none if it is.
std::optional<std::string> RejectionReason(const BoardPatch& patch, const Board& board);

}  // namespace sextant
