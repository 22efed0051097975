// SPDX-License-Identifier: Apache-2.0
#include "io/cameras/camera_file.h"
#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(camera, bytes) {
  CheckRoundTrip(ParseCamera(bytes, "f"), ParseCamera,
                 [](const Camera& camera) { return FormatCameraInfo(camera, "cam"); });
}

}  // namespace sextant::test
