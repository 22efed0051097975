// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "solvers/core/registry.h"

namespace sextant {

// Each binary with the contract tests defines these: the solvers that the tests run for.
SolverRegistry RegistryUnderContract();
std::vector<std::string> SpecsUnderContract();

/// Why a solver may lack a property; empty where it must have it. `property` is a test's name.
std::string ExcuseFrom(const std::string& property, const std::string& spec);

}  // namespace sextant
