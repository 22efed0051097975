// SPDX-License-Identifier: Apache-2.0
#include "io/problems/data_manifest.h"

#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(data_manifest, bytes) { CheckOutcome(ParseManifest(bytes, "f")); }

}  // namespace sextant::test
