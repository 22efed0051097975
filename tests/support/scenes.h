// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "eval/random_scene.h"

namespace sextant::test {

using Scene = RandomScene;
using SceneOptions = RandomSceneOptions;

inline Scene MakeScene(const SceneOptions& options, Random& random) {
  return MakeRandomScene(options, random);
}

}  // namespace sextant::test
