// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solvers/core/registry.h"

namespace sextant {

/// Adds opencv.epnp, opencv.sqpnp, opencv.ippe, opencv.p3p, opencv.iterative, opencv.ransac_epnp
/// and opencv.magsac. Pixels are undistorted by our own camera models. Deterministic: the two
/// randomised solvers draw from generators that OpenCV seeds equally in every call.
void AddOpenCvSolvers(SolverRegistry& registry);

}  // namespace sextant
