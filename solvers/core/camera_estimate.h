// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "geometry/camera.h"
#include "solvers/core/estimated_number.h"

namespace sextant {

/// An intrinsic that was estimated together with the pose; its name is that of IntrinsicName.
using EstimatedIntrinsic = EstimatedNumber;

/// The camera that was estimated together with a pose.
struct CameraEstimate {
  Camera camera;
  std::vector<EstimatedIntrinsic> estimated;  ///< All other intrinsics are as given.
};

}  // namespace sextant
