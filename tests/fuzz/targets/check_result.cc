// SPDX-License-Identifier: Apache-2.0
#include "io/results/check_result.h"

#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(check_result, bytes) { CheckOutcome(ParseCheckResult(bytes, "f")); }

}  // namespace sextant::test
