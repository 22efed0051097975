// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/scene/scene_recording.h"

namespace sextant {

/// One way in which a recording may differ from the one at hand. The right answer stays the same,
/// or becomes "cannot tell".
struct SceneAlteration {
  std::string name;
  std::function<void(RawRecording&)> alter;
  /// Whether "cannot tell" is the only right answer: photos of other moments, other intrinsics.
  bool must_refuse = false;
};

/// Photos that are darker, brighter, blurred, noisy, compressed, cropped or of half the size; scans
/// with fewer rings, in another frame, in another order; scans of other moments; other intrinsics.
std::vector<SceneAlteration> SceneAlterations();

}  // namespace sextant
