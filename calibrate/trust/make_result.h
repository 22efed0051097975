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

/// Settings that are recorded with the result.
struct ResultSettings {
  std::uint64_t seed = 0;
  std::vector<std::string> configuration{};  ///< "name: value" lines.
  std::vector<std::string> warnings{};
};

/// The result as it is written to a file, with views, residuals, boards and camera, but without
/// `trust`. A view counts as kept if one of its boards is; else `reason` has the cause.
CalibrationResult MakeResult(std::span<const SessionView> views, const Assembly& assembly,
                             const SolveReport& report, const ResultSettings& settings);

}  // namespace sextant
