// SPDX-License-Identifier: Apache-2.0
#include "io/results/imported_poses.h"

#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(imported_poses, bytes) { CheckOutcome(ParseImportedPoses(bytes, "f")); }

}  // namespace sextant::test
