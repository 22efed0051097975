// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/random.h"
#include "geometry/camera.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// The camera that simulated sessions without a scene file use: 1280 x 720, f = 700 px.
Camera ZedLikeCamera();

/// A camera beside a LiDAR that looks the same way: some decimetres off, a few degrees turned.
Rigid3d DrawExtrinsic(Random& random);

}  // namespace sextant
