// SPDX-License-Identifier: Apache-2.0
#include "calibrate/session/session.h"

#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(session, bytes) { CheckOutcome(ParseSession(bytes, "f")); }

}  // namespace sextant::test
