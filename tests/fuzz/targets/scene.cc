// SPDX-License-Identifier: Apache-2.0
#include "simulator/scene/scene_file.h"
#include "simulator/session/validate_scene.h"
#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(scene, bytes) {
  const Expected<Scene> scene = ParseScene(bytes, "f");
  CheckOutcome(scene);
  if (scene) CheckOutcome(ValidateScene(*scene));
}

}  // namespace sextant::test
