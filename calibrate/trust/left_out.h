// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "calibrate/match/assemble.h"
#include "solvers/core/solver.h"

namespace sextant {

/// Removes the boards that the solver left out from the assembly: their pairs, raw observations and
/// matches; their rows state it. The report's evaluation and inliers are then those of the
/// remaining data. Nothing changes where all boards, or none, are used.
void LeaveOut(SolveReport& report, Assembly& assembly);

/// The text with each "view 7" (PairId::view) replaced by that view's name: solvers know numbers
/// only. A number without a view stays.
std::string WithViewNames(std::string_view text, std::span<const SessionView> views);

}  // namespace sextant
