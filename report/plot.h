// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "eval/metrics/compare.h"

namespace sextant {

/// Runs gnuplot commands that draw into a file, .svg or .png by its extension; the file is written
/// whole or not at all. Errors: kInvalidOption (another extension), kIo (gnuplot is missing or
/// fails); those of OutputFile.
Expected<void> DrawPlot(const std::string& commands, const std::filesystem::path& path);

/// Commands that plot the residual of every pair for every solver with an answer: of the 3D-3D
/// pairs in millimetres, or else of the 2D-3D pairs in pixels; pairs are labelled
/// view.board.corner.
std::string ResidualPlot(const CalibrationProblem& problem, const std::vector<ComparisonRow>& rows);

}  // namespace sextant
