// SPDX-License-Identifier: Apache-2.0
#include "io/problems/acfr_poses.h"

#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(acfr_poses, bytes) {
  const Expected<std::vector<AcfrPose>> poses = ParseAcfrPoses(bytes, "f");
  CheckOutcome(poses);
  if (poses) CheckOutcome(ProblemFromAcfrPoses(*poses));
}

}  // namespace sextant::test
