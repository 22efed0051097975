// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "geometry/calibration_problem.h"
#include "solvers/core/solver.h"

namespace sextant {

/// Draws every pair on the image: the measured pixel (circle), the LiDAR point projected with the
/// answer (cross), and the residual between them, magnified; pairs that are not inliers are grey.
/// Where a problem has both kinds, those are drawn that the solver needs, by `needs`. For 3D-3D
/// pairs the measured pixel is the projection of the camera point. The file is written whole or not
/// at all. Errors: kIo (an image that cannot be read or written), kMissingData (no camera or no
/// pairs), kInvalidInput (an image whose size is not the camera's).
Expected<void> DrawOverlay(const CalibrationProblem& problem, const SolveReport& report,
                           const DataNeeds& needs, const std::filesystem::path& image,
                           const std::filesystem::path& out);

}  // namespace sextant
