// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "base/error.h"
#include "simulator/scene/scene.h"

namespace sextant {

/// What both sensors see of a scene, for people: the first camera's image, the scan from the
/// LiDAR's place coloured by range, and its points at jumps in range near the boards, with the
/// boards' true outlines. 8-bit BGR, three panels of 480 rows. The first scan of the session of
/// that seed. Errors: those of ValidateScene.
Expected<cv::Mat> DrawContactSheet(const Scene& scene, std::uint64_t seed);

}  // namespace sextant
