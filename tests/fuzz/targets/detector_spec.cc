// SPDX-License-Identifier: Apache-2.0
#include "features/camera/tag_detector.h"
#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(detector_spec, bytes) {
  const Expected<TagDetectorPtr> detector = MakeTagDetector(bytes);
  CheckOutcome(detector);
}

}  // namespace sextant::test
