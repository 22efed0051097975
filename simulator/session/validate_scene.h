// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/error.h"
#include "simulator/scene/scene.h"

namespace sextant {

/// Whether a session of calibration can be simulated in the scene, before any work is done:
/// - known LiDAR and camera models, an image with a size, told intrinsics of the same size;
/// - finite poses, positive sizes, surfaces within [0, 1], boards without a BoardFault, tags that
///   their families have;
/// - sensors outside boxes and cylinders, and not closer than 1 cm to a board or wall;
/// - boards that cross no wall, box, cylinder or other board, neither at rest nor at the ends of
///   their swing; touching with 1 mm is no crossing;
/// - of each board, a part that a camera sees from the front, and a part that the LiDAR reaches by
///   its angles and its range. What hides what is not looked at.
///
/// Errors: kInvalidInput, kNonFinite and kUnknownName, naming the thing and what to do.
Expected<void> ValidateScene(const Scene& scene);

}  // namespace sextant
