// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "geometry/camera.h"
#include "simulator/camera/camera_view.h"

namespace sextant {

/// The mean radiance over each pixel's square, CV_32F; 0 where the lens has no image.
///
/// A pixel whose corners see the same patch, away from other layers, is uniform. A pixel that is
/// divided by one straight edge has the exact mean of its two areas. Every other pixel (corners of
/// prints, crossing edges, round objects) is the mean over a Fibonacci lattice (Korobov 1959) of
/// 377 rays, whose projections on both axes are evenly spaced. Near objects that look narrower than
/// a few pixels (poles, boards seen edge-on), all pixels are sampled; objects narrower than a sixth
/// of a pixel may be missed. Blocks of pixels are processed in parallel, with the same bits on any
/// number of threads.
cv::Mat SampleAreas(const Camera& camera, const CameraView& view);

}  // namespace sextant
