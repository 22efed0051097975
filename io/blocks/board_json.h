// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "geometry/board.h"

namespace sextant {

/// The keys of a board file (io/blocks/board_block.h); what is absent has none.
nlohmann::ordered_json BoardJson(const Board& board);

}  // namespace sextant
