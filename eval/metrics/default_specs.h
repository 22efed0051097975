// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "geometry/calibration_problem.h"
#include "solvers/core/registry.h"

namespace sextant {

/// Every solver of the registry whose needs the problem meets, in the registry's order, by
/// canonical name: plain ones as they are, combinators around the closed form of each kind of pairs
/// (kabsch, epnp) and around nothing else. Empty where only a baseline is left.
std::vector<std::string> DefaultSpecs(const SolverRegistry& registry,
                                      const CalibrationProblem& problem);

}  // namespace sextant
