// SPDX-License-Identifier: Apache-2.0
#include "geometry/camera.h"

namespace sextant {

Expected<void> ValidateCamera(const Camera&) { return {}; }

std::optional<Eigen::Vector2d> Project(const Camera& c, const Eigen::Vector3d& p) {
  if (p.z() <= 0) return std::nullopt;
  return Eigen::Vector2d(c.fx_px * p.x() / p.z() + c.cx_px, c.fy_px * p.y() / p.z() + c.cy_px);
}

}  // namespace sextant
