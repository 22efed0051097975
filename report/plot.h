// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "eval/metrics/compare.h"

namespace sextant {

/// Draws gnuplot commands into a file, .svg or .png by its extension; the file appears whole or not
/// at all. Errors: kInvalidOption (another extension), kIo (gnuplot missing or refusing).
Expected<void> DrawPlot(const std::string& commands, const std::filesystem::path& path);

/// Commands that plot the residual of every pair under every solver that answered: millimetres of
/// the 3D-3D pairs, else pixels of the 2D-3D pairs; pairs are grouped by view and board.
std::string ResidualPlot(const CalibrationProblem& problem, const std::vector<ComparisonRow>& rows);

}  // namespace sextant
