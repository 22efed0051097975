// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "calibrate/calibrate.h"
#include "io/results/calibration_result.h"
#include "report/page/page.h"

namespace sextant {

/// The files behind a result with their SHA-256: boards, camera and recording where the calibration
/// is known (it may be null), photos and scans. Reads every file on all cores, and in later calls
/// only those that are new or changed.
PageInputs InputsOf(const CalibrationResult& result, const Calibration* calibration,
                    const std::filesystem::path& folder);

}  // namespace sextant
