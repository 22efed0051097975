// SPDX-License-Identifier: Apache-2.0
#include "io/results/rig_result.h"

#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(rig_result, bytes) { CheckOutcome(ParseRigResult(bytes, "f")); }

}  // namespace sextant::test
