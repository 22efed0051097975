// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>

#include "geometry/camera.h"

namespace sextant {

/// Where a camera's model is valid, and why a point or a pixel is outside.

/// Whether the image grows all the way from the axis to `radius`: in the plane z = 1 or, for the
/// omnidirectional model, the plane that is distorted; for a fisheye an angle in rad. True for the
/// double sphere, which has no polynomial.
bool GrowsUpTo(const Camera& camera, double radius);

/// The end of the domain: the angle from the axis [rad] up to which the radial part of the model
/// projects, at most pi; half of pi at most for pinhole and Brown-Conrady.
double DomainEnd(const Camera& camera);

/// What ends the domain, as a phrase: "the rational distortion has a pole at r = 0.809, 39.0 deg
/// from the axis, where 1 + k4 r^2 + k5 r^4 + k6 r^6 is 0".
std::string DomainText(const Camera& camera);

/// Why the point has no pixel, as a phrase: "it is behind the camera (z = -0.3 m)", or the end of
/// the domain. For points that Project refuses.
std::string WhyNotProjected(const Camera& camera, const Eigen::Vector3d& point_in_cam);

}  // namespace sextant
