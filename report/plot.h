// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "eval/metrics/compare.h"

namespace sextant {

/// Writes the picture that gnuplot draws by the commands, .svg, .png or .pdf by the file's
/// extension. Errors: kInvalidOption (another extension), kIo, those of RunGnuplot, whose header
/// says what the commands may contain.
Expected<void> DrawPlot(const std::string& commands, const std::filesystem::path& path);

/// Commands that plot the residual of every pair for every solver with an answer: of the 3D-3D
/// pairs in millimetres, or else of the 2D-3D pairs in pixels; pairs are labelled
/// view.board.corner.
std::string ResidualPlot(const CalibrationProblem& problem, const std::vector<ComparisonRow>& rows);

}  // namespace sextant
