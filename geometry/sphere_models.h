// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "geometry/camera.h"
#include "geometry/lens.h"

namespace sextant {

/// Models that project onto a unit sphere first, and onto a plane from another centre. They take
/// points beyond 90 degrees, with z <= 0.

/// Unified model of Mei and Rives 2007 (ICRA; Geyer and Daniilidis 2000; OpenCV's `omnidir`): with
/// d = |p|, m = (x, y) / (z + xi d), distorted by k1 k2 p1 p2 k3 (DistortPlane). xi = 0 is a
/// Brown-Conrady camera. None where z + xi d <= 0, and for xi > 1 where z <= -d / xi, from where on
/// the image shrinks again.
std::optional<LensImage> ProjectOmnidirectional(const Camera& camera,
                                                const Eigen::Vector3d& point_in_cam);
std::optional<Eigen::Vector3d> RayOfOmnidirectional(const Camera& camera,
                                                    const Eigen::Vector2d& image);

/// Double sphere (Usenko, Demmel and Cremers 2018, 3DV): with d1 = |p|, k = z + xi d1 and
/// d2 = |(x, y, k)|, (x, y) / (alpha d2 + (1 - alpha) k). xi = alpha = 0 is a pinhole. None where
/// z <= -w2 d1, w2 = (w1 + xi) / sqrt(2 w1 xi + xi^2 + 1), w1 = alpha / (1 - alpha) for
/// alpha <= 1/2 and (1 - alpha) / alpha above.
std::optional<LensImage> ProjectDoubleSphere(const Camera& camera,
                                             const Eigen::Vector3d& point_in_cam);
std::optional<Eigen::Vector3d> RayOfDoubleSphere(const Camera& camera,
                                                 const Eigen::Vector2d& image);

}  // namespace sextant
