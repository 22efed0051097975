// SPDX-License-Identifier: Apache-2.0
#include "io/results/calibration_result.h"

#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(calibration_result, bytes) {
  const Expected<CalibrationResult> result = ParseCalibrationResult(bytes, "f");
  CheckRoundTrip(result, ParseCalibrationResult, FormatCalibrationResult);
  CheckRoundTrip(result, ParseCalibrationResult, FormatCalibrationResultJson);
}

}  // namespace sextant::test
