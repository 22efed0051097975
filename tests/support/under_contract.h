// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "solvers/core/registry.h"

namespace sextant {

// Defined by each binary with the contract tests: the solvers to test.
SolverRegistry RegistryUnderContract();
std::vector<std::string> SpecsUnderContract();

/// The reason why a solver is exempt from a test; empty if it is not. `promise` is the name of the
/// test.
std::string ExcuseFrom(const std::string& promise, const std::string& spec);

}  // namespace sextant
