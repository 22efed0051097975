// SPDX-License-Identifier: Apache-2.0
#include "calibrate/session/session.h"

#include "calibrate/session/rig_session.h"
#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/input_file.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

// A session of one camera and one LiDAR, or of a rig.
SEXTANT_FUZZ_TARGET(session, bytes) {
  static InputFile file("session.yaml");
  CheckOutcome(ParseSession(bytes, "f"));
  CheckOutcome(ReadRigSession(file.Write(bytes)));
}

}  // namespace sextant::test
