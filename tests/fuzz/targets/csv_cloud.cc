// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/csv_cloud.h"

#include "tests/fuzz/cloud.h"
#include "tests/fuzz/entry_point.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(csv_cloud, bytes) { CheckCloud(ParseCsvCloud(bytes, "f")); }

}  // namespace sextant::test
