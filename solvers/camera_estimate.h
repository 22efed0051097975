// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/camera.h"

namespace sextant {

/// An intrinsic that was estimated along with the pose.
struct EstimatedIntrinsic {
  std::string name;  ///< See IntrinsicName.
  double value = 0.0;
  std::optional<double> sigma;  ///< None where the data leaves no residual to judge by.
};

/// The camera that goes with a pose, where it was estimated too.
struct CameraEstimate {
  Camera camera;
  std::vector<EstimatedIntrinsic> estimated;  ///< All others are as given.
};

}  // namespace sextant
