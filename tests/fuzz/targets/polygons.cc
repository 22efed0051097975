// SPDX-License-Identifier: Apache-2.0
#include "io/boards/polygon_file.h"
#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(polygons, bytes) {
  CheckRoundTrip(ParsePolygons(bytes, "f"), ParsePolygons, FormatPolygons);
}

}  // namespace sextant::test
