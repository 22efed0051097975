// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "geometry/camera.h"
#include "geometry/rigid3d.h"
#include "solvers/kernels/pixel_terms.h"

namespace sextant {

/// A start for least squares on all pixels of a pinhole camera: the P3P pose with the smallest sum
/// of squares over the terms, from up to eight triples of pixels far apart in the image, which are
/// solved in one SIMD vector of 8 doubles. Uses at most 32 terms. Allocates nothing. None where no
/// triple has a pose.
std::optional<Rigid3d> StartFromTriples(PixelTermsView terms, const Camera& camera);

}  // namespace sextant
