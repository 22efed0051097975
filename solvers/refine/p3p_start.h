// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "geometry/camera.h"
#include "geometry/rigid3d.h"
#include "solvers/kernels/pixel_terms.h"

namespace sextant {

/// A pose from which least squares on all pixels of a pinhole camera finds its minimum: of the
/// poses of up to eight triples of pixels far apart in the image, solved side by side, the one with
/// the least squares over the terms. Looks at 32 terms at the most. Allocates nothing. None where
/// no triple gives a pose.
std::optional<Rigid3d> StartFromTriples(PixelTermsView terms, const Camera& camera);

}  // namespace sextant
