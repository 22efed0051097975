// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/error.h"
#include "simulator/scene/scene.h"

namespace sextant {

/// Checks whether a calibration session can be simulated in the scene:
/// - known LiDAR and camera models, a valid image size, assumed intrinsics with the same size;
/// - finite poses, positive sizes, surfaces within [0, 1], boards without a BoardFault, tags that
///   their families have;
/// - sensors outside boxes and cylinders, and not closer than 1 cm to a board or wall;
/// - boards that cross no wall, box, cylinder or other board, neither at rest nor at the ends of
///   their swing; touching with 1 mm is no crossing;
/// - part of each board visible from the front in a camera, and part of it within the angles and
///   the range of the LiDAR. Occlusions are ignored.
///
/// Errors: kInvalidInput, kNonFinite and kUnknownName; messages name the object and give advice.
Expected<void> ValidateScene(const Scene& scene);

}  // namespace sextant
