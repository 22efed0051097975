// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/npy_cloud.h"
#include "tests/fuzz/cloud.h"
#include "tests/fuzz/entry_point.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(npy, bytes) { CheckCloud(ParseNpyCloud(bytes, "f")); }

}  // namespace sextant::test
