// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/las_cloud.h"
#include "tests/fuzz/cloud.h"
#include "tests/fuzz/entry_point.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(las, bytes) { CheckCloud(ParseLasCloud(bytes, "f")); }

}  // namespace sextant::test
