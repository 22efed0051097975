// SPDX-License-Identifier: Apache-2.0
#include "io/problems/problem_yaml.h"

#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(problem_yaml, bytes) {
  CheckRoundTrip(ParseProblemYaml(bytes, "f"), ParseProblemYaml, FormatProblemYaml);
}

}  // namespace sextant::test
