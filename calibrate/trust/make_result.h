// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "calibrate/match/assemble.h"
#include "io/results/calibration_result.h"
#include "solvers/core/solver.h"

namespace sextant {

/// What shaped the answer besides the measurements.
struct ResultSettings {
  std::uint64_t seed = 0;
  std::vector<std::string> configuration{};  ///< "name: value" each.
  std::vector<std::string> warnings{};
};

/// The answer with its views, residuals, boards and camera, as it is written to a file: all but
/// `trust`. A view is kept where one of its boards is; else `reason` says why it was not.
CalibrationResult MakeResult(std::span<const SessionView> views, const Assembly& assembly,
                             const SolveReport& report, const ResultSettings& settings);

}  // namespace sextant
