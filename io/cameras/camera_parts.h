// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "geometry/camera.h"

namespace sextant {

/// The content of a camera file, independent of its format.
struct CameraParts {
  int width_px = 0;
  int height_px = 0;
  std::array<double, 9> matrix{};  ///< K, row by row.
  std::span<const double> distortion;
  std::string_view model;  ///< The distortion model in ROS's terms; empty if the file has none.
  double xi = 0.0;         ///< For the omnidirectional and double-sphere models.
  double alpha = 0.0;      ///< For the double-sphere model.
};

/// The name of a camera's distortion model in ROS's files, ours where ROS has none, and the number
/// of coefficients that it has.
struct RosDistortion {
  const char* model;
  std::size_t coefficients;
};
RosDistortion RosDistortionOf(const Camera& camera);

/// Makes the camera from these parts. Error: kInvalidInput, which states what was expected.
Expected<Camera> CameraFromParts(const CameraParts& parts);

}  // namespace sextant
