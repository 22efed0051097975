// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/pcd_file.h"
#include "tests/fuzz/cloud.h"
#include "tests/fuzz/entry_point.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(pcd, bytes) { CheckCloud(ParsePcd(bytes, "f")); }

}  // namespace sextant::test
