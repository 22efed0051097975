// SPDX-License-Identifier: Apache-2.0
#include "io/original/average_log.h"

#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(average_log, bytes) { CheckOutcome(ParseAverageLog(bytes, "f")); }

}  // namespace sextant::test
