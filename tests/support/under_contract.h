// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "solvers/core/registry.h"

namespace sextant {

// Each binary that holds the contract tests defines these: the solvers that they run for.
SolverRegistry RegistryUnderContract();
std::vector<std::string> SpecsUnderContract();

/// Why a solver need not keep a promise; empty where it must. `promise` is a test's name.
std::string ExcuseFrom(const std::string& promise, const std::string& spec);

}  // namespace sextant
