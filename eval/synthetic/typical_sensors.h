// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/random.h"
#include "geometry/camera.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// The camera of simulated sessions without a scene file: 1280 x 720 pixels, f = 700 px.
Camera ZedLikeCamera();

/// Random cam_from_lidar of a camera that is mounted next to the LiDAR and looks along its x axis:
/// offset by a few decimetres, rotated by a few degrees.
Rigid3d DrawExtrinsic(Random& random);

}  // namespace sextant
