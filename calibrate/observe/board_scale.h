// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/board.h"

namespace sextant {

/// Multiplies the outline and the holes of a board.
void ScaleOutline(double factor, Board& board);

/// Multiplies what is printed on a board, and where it is.
void ScalePrint(double factor, Board& board);

}  // namespace sextant
