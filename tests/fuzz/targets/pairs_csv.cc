// SPDX-License-Identifier: Apache-2.0
#include "io/problems/pairs_csv.h"

#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(pairs_csv, bytes) {
  CheckRoundTrip(ParsePairsCsv(bytes, "f"), ParsePairsCsv, [](const CalibrationProblem& problem) {
    return problem.pairs_3d3d.empty() ? FormatPairsCsv(problem.pairs_2d3d)
                                      : FormatPairsCsv(problem.pairs_3d3d);
  });
}

}  // namespace sextant::test
