// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "base/error.h"
#include "simulator/scene/scene.h"

namespace sextant {

/// An overview image of a scene: the first camera's image, the scan seen from the LiDAR and
/// coloured by range, and the points at range jumps near the boards with the boards' true outlines.
/// 8-bit BGR, three panels of 480 rows, from the first scan of the session with this seed. Errors:
/// those of ValidateScene.
Expected<cv::Mat> DrawContactSheet(const Scene& scene, std::uint64_t seed);

}  // namespace sextant
