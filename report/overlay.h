// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "geometry/calibration_problem.h"
#include "solvers/core/solver.h"

namespace sextant::cli {

/// Draws every pair onto the image: the measured pixel (circle), the LiDAR point under the answer
/// (cross), and the residual between them, magnified; pairs that the answer does not rest on are
/// grey. For 3D-3D pairs alone the measured pixel is the camera point's own projection. The file
/// appears whole or not at all.
/// Errors: kIo (an image that cannot be read or written), kMissingData (no camera or no pairs),
/// kInvalidInput (an image of another size than the camera's).
Expected<void> DrawOverlay(const CalibrationProblem& problem, const SolveReport& report,
                           const std::filesystem::path& image, const std::filesystem::path& out);

}  // namespace sextant::cli
