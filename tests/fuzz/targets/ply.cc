// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/ply_file.h"
#include "tests/fuzz/cloud.h"
#include "tests/fuzz/entry_point.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(ply, bytes) { CheckCloud(ParsePly(bytes, "f")); }

}  // namespace sextant::test
