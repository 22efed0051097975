// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "solvers/core/registry.h"

namespace sextant::python {

/// Every solver of the build and those that Python registered. A snapshot, which stays as it is
/// while other threads register solvers. Needs the GIL.
std::shared_ptr<const SolverRegistry> Catalogue();

/// Adds a solver, or replaces the one that Python registered under this name. Needs the GIL.
/// Errors: kInvalidInput for a name that is not one, or that a solver of the build has.
Expected<void> Register(SolverEntry entry);

}  // namespace sextant::python
