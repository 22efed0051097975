// SPDX-License-Identifier: Apache-2.0
#include "io/poses/pose_file.h"

#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/input_file.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(pose_file, bytes) {
  static InputFile file("pose.yaml");
  CheckOutcome(ReadPoseFile(file.Write(bytes)));
}

}  // namespace sextant::test
