// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/error.h"
#include "solvers/core/rig_problem.h"

namespace sextant {

/// Finds what is wrong with points and planes that somebody has extracted, by each sensor alone:
/// another unit, corners in another order or counter-clockwise, the other sign of a plane's
/// distance. A sensor is judged by most of its observations. Errors: kInvalidInput, with the sensor
/// and the remedy. Requires a problem that passes CheckRigProblem.
Expected<void> CheckRigFeatures(const RigProblem& problem);

}  // namespace sextant
