// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/ceres.h>

#include "solvers/refine/refine_ceres.h"

namespace sextant {

/// A loss to be owned by a ceres::Problem; null for plain least squares.
ceres::LossFunction* NewLoss(const RobustLoss& loss);

ceres::Solver::Options CeresOptions(const RefineLimits& limits);

RefineOutcome OutcomeOf(ceres::TerminationType termination);

}  // namespace sextant
