// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/cloud.h"

#include "io/clouds/cloud_file.h"
#include "tests/fuzz/entry_point.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(cloud, bytes) { CheckCloud(ParseCloud(bytes, "f")); }

}  // namespace sextant::test
