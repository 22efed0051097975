// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calibrate/match/assemble.h"
#include "solvers/core/solver.h"

namespace sextant {

/// The answer in words, a paragraph: which frame is mapped to which, what it rests on, how sure it
/// is, what limits it, and what would make it better.
std::string ClosingParagraph(const Assembly& assembly, const SolveReport& report);

}  // namespace sextant
