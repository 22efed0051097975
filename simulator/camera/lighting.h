// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace sextant {

/// Light of a simulated room: ambient light, and one distant lamp that casts no shadows. A flat
/// face is uniformly illuminated, so that only the camera affects the shape of edges in an image.
struct Lighting {
  double ambient = 0.55;  ///< Fraction of ambient light, in [0, 1].
  /// Direction towards the lamp, of any length. Boards that face a sensor at the world's origin
  /// have normals along -x.
  Eigen::Vector3d lamp_in_world = Eigen::Vector3d(-0.6, 0.25, 0.75);
};

/// ambient + (1 - ambient) max(0, cos of the angle between lamp and outward normal), in [0, 1]
/// (Lambert 1760). The normal is a unit vector.
double Irradiance(const Lighting& lighting, const Eigen::Vector3d& normal_in_world);

}  // namespace sextant
