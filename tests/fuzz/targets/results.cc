// SPDX-License-Identifier: Apache-2.0
#include "io/results/results_json.h"
#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(results, bytes) {
  CheckRoundTrip(ParseResults(bytes, "f"), ParseResults, FormatResults);
}

}  // namespace sextant::test
