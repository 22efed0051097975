// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "geometry/camera.h"
#include "solvers/core/estimated_number.h"

namespace sextant {

/// An intrinsic that was estimated along with the pose; named as IntrinsicName does.
using EstimatedIntrinsic = EstimatedNumber;

/// The camera that goes with a pose, where it was estimated too.
struct CameraEstimate {
  Camera camera;
  std::vector<EstimatedIntrinsic> estimated;  ///< All others are as given.
};

}  // namespace sextant
