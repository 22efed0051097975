// SPDX-License-Identifier: Apache-2.0
#include "io/problems/rig_yaml.h"
#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(rig_file, bytes) {
  CheckRoundTrip(ParseRigFile(bytes, "f"), ParseRigFile, FormatRigFile);
}

}  // namespace sextant::test
