// SPDX-License-Identifier: Apache-2.0
#include "io/results/pose_answer.h"

#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(pose_answer, bytes) { CheckOutcome(ParsePoseAnswer(bytes, 5)); }

}  // namespace sextant::test
