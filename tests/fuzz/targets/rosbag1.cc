// SPDX-License-Identifier: Apache-2.0
#include "io/bag/open_bytes.h"
#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/recording.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(rosbag1, bytes) { ReadRecording(OpenRosbag1(bytes, "f", nullptr)); }

}  // namespace sextant::test
