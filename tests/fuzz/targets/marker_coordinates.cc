// SPDX-License-Identifier: Apache-2.0
#include "io/boards/marker_files.h"
#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(marker_coordinates, bytes) { CheckOutcome(ParseMarkerCoordinates(bytes, "f")); }

}  // namespace sextant::test
