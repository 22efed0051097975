// SPDX-License-Identifier: Apache-2.0
#include "calibrate/session/rig_session.h"

#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/input_file.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(rig_session, bytes) {
  static InputFile file("session.yaml");
  CheckOutcome(ReadRigSession(file.Write(bytes)));
}

}  // namespace sextant::test
