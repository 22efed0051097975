// SPDX-License-Identifier: Apache-2.0
#include "io/results/rig_result.h"

#include "io/results/check_result.h"
#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

// And the other result in JSON, of a check.
SEXTANT_FUZZ_TARGET(rig_result, bytes) {
  CheckOutcome(ParseRigResult(bytes, "f"));
  CheckOutcome(ParseCheckResult(bytes, "f"));
}

}  // namespace sextant::test
