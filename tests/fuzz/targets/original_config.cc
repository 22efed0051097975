// SPDX-License-Identifier: Apache-2.0
#include "io/original/original_config.h"

#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(original_config, bytes) { CheckOutcome(ParseOriginalConfig(bytes, "f")); }

}  // namespace sextant::test
