// SPDX-License-Identifier: Apache-2.0
#include "geometry/scan_marks.h"

namespace sextant {
namespace {

// The sign states on which side of the line from a to b the point c lies.
double Side(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const Eigen::Vector2d ab = b - a;
  const Eigen::Vector2d ac = c - a;
  return ab.x() * ac.y() - ab.y() * ac.x();
}

bool Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
           const Eigen::Vector2d& d) {
  return Side(a, b, c) * Side(a, b, d) < 0.0 && Side(c, d, a) * Side(c, d, b) < 0.0;
}

}  // namespace

bool Contains(const Quadrilateral& quadrilateral, const Eigen::Vector2d& pixel) {
  bool inside = false;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d& a = quadrilateral[i];
    const Eigen::Vector2d& b = quadrilateral[(i + 1) % 4];
    if ((a.y() > pixel.y()) == (b.y() > pixel.y())) continue;
    const double x = a.x() + (pixel.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    if (pixel.x() < x) inside = !inside;
  }
  return inside;
}

bool CrossesItself(const Quadrilateral& quadrilateral) {
  const auto& [a, b, c, d] = quadrilateral;
  return Cross(a, b, c, d) || Cross(b, c, d, a);
}

Eigen::Vector2d CenterOf(const Quadrilateral& quadrilateral) {
  return 0.25 * (quadrilateral[0] + quadrilateral[1] + quadrilateral[2] + quadrilateral[3]);
}

Rigid3d AxesCamFromLidar() {
  return {Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), Eigen::Vector3d::Zero()};
}

Camera AssumedCamera(int width_px, int height_px) {
  return {.model = CameraModel::kPinhole,
          .width_px = width_px,
          .height_px = height_px,
          .fx_px = 0.5 * width_px,
          .fy_px = 0.5 * width_px,
          .cx_px = 0.5 * (width_px - 1),
          .cy_px = 0.5 * (height_px - 1)};
}

}  // namespace sextant
