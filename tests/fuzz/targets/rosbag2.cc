// SPDX-License-Identifier: Apache-2.0
#include "io/bag/open_bytes.h"
#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/input_file.h"
#include "tests/fuzz/recording.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(rosbag2, bytes) {
  static InputFile file("recording.db3");
  ReadRecording(OpenRosbag2Sqlite(file.Write(bytes)));
}

}  // namespace sextant::test
