// SPDX-License-Identifier: Apache-2.0
#include "calibrate/observe/photo_file.h"
#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/input_file.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(image, bytes) {
  static InputFile file("image");
  CheckOutcome(ReadImage(file.Write(bytes)));
}

}  // namespace sextant::test
