// SPDX-License-Identifier: Apache-2.0
#include "io/problems/read_problem.h"
#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(problem, bytes) { CheckOutcome(ParseProblem(bytes, "f")); }

}  // namespace sextant::test
