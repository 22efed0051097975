// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/error.h"
#include "solvers/core/rig_problem.h"

namespace sextant {

/// Whether the problem is usable: names are distinct, observations name sensors and boards that
/// exist and have the right kind of data for them, each sensor once a placement; numbers are finite
/// and sigmas positive. Errors: kMissingData, kNonFinite, kInvalidInput.
Expected<void> CheckRigProblem(const RigProblem& problem);

}  // namespace sextant
