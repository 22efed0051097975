// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/reproduction/claims.h"

#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(claims, bytes) { CheckOutcome(ParseClaims(bytes, "f")); }

}  // namespace sextant::test
