// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "geometry/calibration_problem.h"
#include "solvers/core/registry.h"

namespace sextant {

/// Canonical names of all solvers of the registry whose requirements the problem meets, in the
/// registry's order. Combinators are listed around the closed forms of both kinds of pairs only
/// (kabsch, epnp). Empty if only baselines would remain.
std::vector<std::string> DefaultSpecs(const SolverRegistry& registry,
                                      const CalibrationProblem& problem);

/// The solver for those who name none: kabsch for 3D-3D pairs, or robust(kabsch) where that leaves
/// out pairs that noise does not explain (OutlyingPairs); for 2D-3D pairs refine(sqpnp), or
/// refine(ransac(p3p)) where that leaves out such pairs or the first finds no pose, or p3p for
/// three pairs. Solves once or twice.
std::string DefaultSpec(const SolverRegistry& registry, const CalibrationProblem& problem);

}  // namespace sextant
