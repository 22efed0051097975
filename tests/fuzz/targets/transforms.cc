// SPDX-License-Identifier: Apache-2.0
#include "io/problems/transform_list.h"
#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(transforms, bytes) { CheckOutcome(ParseTransformList(bytes, "f")); }

}  // namespace sextant::test
