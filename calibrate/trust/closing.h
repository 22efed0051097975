// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calibrate/match/assemble.h"
#include "solvers/core/solver.h"

namespace sextant {

/// Summary of the answer as one paragraph: direction of the transform, data it is based on,
/// uncertainty, what limits the accuracy, and what would improve it.
std::string ClosingParagraph(const Assembly& assembly, const SolveReport& report);

}  // namespace sextant
