// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "features/lidar/board_finder.h"

namespace sextant {

/// Follows every ray onto the placed board and around it.
BoardAgreement AgreementOf(const ScanRings& scan, const BoardPatch& patch, const Board& board);

/// How far a return is beyond the placed board's nearest side, in its plane; negative inside.
double BeyondBoard(const BoardPatch& patch, const Board& board, const Eigen::Vector2d& in_plane);

/// Why the patch is not this board; none where it is.
std::optional<std::string> RejectionReason(const BoardPatch& patch, const Board& board);

}  // namespace sextant
