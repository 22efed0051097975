// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "calibrate/match/assemble.h"
#include "solvers/core/board_view_fit.h"

namespace sextant {

/// Removes the boards that a solver left out from the assembly: their pairs, raw observations and
/// matches. Their rows state it. Returns whether there was one; false, with nothing removed, if
/// none would remain.
bool LeaveOut(std::span<const BoardViewFit> fits, Assembly& assembly);

/// The text with each "view 7" (PairId::view) replaced by that view's name: solvers know numbers
/// only. A number without a view stays.
std::string WithViewNames(std::string_view text, std::span<const SessionView> views);

}  // namespace sextant
