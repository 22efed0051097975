// SPDX-License-Identifier: Apache-2.0
#include "simulator/camera/lighting.h"

#include <algorithm>

namespace sextant {

double Irradiance(const Lighting& lighting, const Eigen::Vector3d& normal_in_world) {
  const double cosine = normal_in_world.dot(lighting.lamp_in_world.normalized());
  return lighting.ambient + (1.0 - lighting.ambient) * std::max(0.0, cosine);
}

}  // namespace sextant
