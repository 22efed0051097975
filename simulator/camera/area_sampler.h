// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "geometry/camera.h"
#include "simulator/camera/camera_view.h"

namespace sextant {

/// The mean radiance over each pixel's square, CV_32F, one row a row; 0 where the lens has no
/// image.
///
/// A pixel whose corners see one patch, away from other layers, is even. One that a straight edge
/// cuts in two has the exact mean of its two areas. Every other one (corners of prints, crossing
/// edges, round things) is the mean over a Fibonacci lattice (Korobov 1959) of 377 rays, whose
/// projections on both axes are evenly spaced. Where poles or boards from their edge look narrower
/// than some pixels all pixels around are probed for them; narrower than a sixth of a pixel they
/// may be missed. Blocks of pixels in parallel; the same bits on any number of threads.
cv::Mat SampleAreas(const Camera& camera, const CameraView& view);

}  // namespace sextant
