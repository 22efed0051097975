// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

#include "geometry/camera.h"

namespace sextant {

/// What camera files state, whatever their form.
struct CameraParts {
  int width_px = 0;
  int height_px = 0;
  std::array<double, 9> matrix{};  ///< K, row by row.
  std::span<const double> distortion;
  std::string_view model;  ///< As ROS names it; empty where the file does not say.
};

/// The camera of these parts. Errors: kInvalidInput, with what was expected.
Expected<Camera> CameraFromParts(const CameraParts& parts);

}  // namespace sextant
