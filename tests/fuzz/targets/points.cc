// SPDX-License-Identifier: Apache-2.0
#include "io/problems/points_file.h"
#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(points, bytes) {
  CheckRoundTrip(ParsePoints(bytes, "f"), ParsePoints, [](const CalibrationProblem& problem) {
    return FormatPoints(problem.pairs_3d3d);
  });
}

}  // namespace sextant::test
