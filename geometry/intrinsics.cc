// SPDX-License-Identifier: Apache-2.0
#include "geometry/intrinsics.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/distortion.h"

namespace sextant {
namespace {

using ByDistortion = Eigen::Matrix<double, 2, 8>;

// Derivative of the point of Distort by the coefficients; the equations are in distortion.h.
ByDistortion BrownByCoefficients(const Camera& camera, const Eigen::Vector2d& m) {
  const std::array<double, 8>& k = camera.distortion;
  const double s = m.squaredNorm();
  const double numerator = 1.0 + s * (k[0] + s * (k[1] + s * k[4]));
  const double denominator = 1.0 + s * (k[5] + s * (k[6] + s * k[7]));
  const Eigen::Vector2d by_numerator = m / denominator;
  const Eigen::Vector2d by_denominator = -numerator / denominator * by_numerator;
  const double xy = m.x() * m.y();
  ByDistortion d;
  d.col(0) = s * by_numerator;
  d.col(1) = s * s * by_numerator;
  d.col(2) << 2.0 * xy, s + 2.0 * m.y() * m.y();
  d.col(3) << s + 2.0 * m.x() * m.x(), 2.0 * xy;
  d.col(4) = s * s * s * by_numerator;
  d.col(5) = s * by_denominator;
  d.col(6) = s * s * by_denominator;
  d.col(7) = s * s * s * by_denominator;
  return d;
}

ByDistortion EquidistantByCoefficients(const Eigen::Vector2d& m) {
  ByDistortion d = ByDistortion::Zero();
  const double r = m.norm();
  if (r == 0.0) return d;
  const double theta = std::atan(r);
  double power = theta;
  for (int i = 0; i < 4; ++i) {
    power *= theta * theta;
    d.col(i) = power / r * m;
  }
  return d;
}

}  // namespace

IntrinsicVector IntrinsicsOf(const Camera& camera) {
  IntrinsicVector numbers;
  numbers.head<4>() << camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px;
  numbers.tail<8>() = Eigen::Map<const Eigen::Matrix<double, 8, 1>>(camera.distortion.data());
  return numbers;
}

Camera WithIntrinsics(const Camera& camera, const IntrinsicVector& numbers) {
  Camera changed = camera;
  changed.fx_px = numbers[0];
  changed.fy_px = numbers[1];
  changed.cx_px = numbers[2];
  changed.cy_px = numbers[3];
  std::copy(numbers.data() + kFirstDistortion, numbers.data() + kIntrinsicCount,
            changed.distortion.begin());
  return changed;
}

std::string_view IntrinsicName(CameraModel model, int index) {
  constexpr std::array<std::string_view, 4> kFirst = {"fx_px", "fy_px", "cx_px", "cy_px"};
  constexpr std::array<std::string_view, 8> kBrown = {"k1", "k2", "p1", "p2",
                                                      "k3", "k4", "k5", "k6"};
  constexpr std::array<std::string_view, 8> kFisheye = {"k1", "k2", "k3", "k4", "-", "-", "-", "-"};
  if (index < kFirstDistortion) return kFirst[static_cast<std::size_t>(index)];
  const auto i = static_cast<std::size_t>(index - kFirstDistortion);
  return model == CameraModel::kEquidistant ? kFisheye[i] : kBrown[i];
}

std::optional<Eigen::Matrix<double, 2, kIntrinsicCount>> PixelByIntrinsics(
    const Camera& camera, const Eigen::Vector3d& point_in_cam) {
  if (!(point_in_cam.z() > 0.0)) return std::nullopt;
  const Eigen::Vector2d undistorted = point_in_cam.head<2>() / point_in_cam.z();
  const std::optional<Distorted> distorted = Distort(camera, undistorted);
  if (!distorted) return std::nullopt;
  Eigen::Matrix<double, 2, kIntrinsicCount> d = Eigen::Matrix<double, 2, kIntrinsicCount>::Zero();
  d(0, 0) = distorted->point.x();
  d(1, 1) = distorted->point.y();
  d.block<2, 2>(0, 2).setIdentity();
  if (camera.model == CameraModel::kPinhole) return d;
  const ByDistortion by_distortion = camera.model == CameraModel::kBrownConrady
                                         ? BrownByCoefficients(camera, undistorted)
                                         : EquidistantByCoefficients(undistorted);
  d.row(0).tail<8>() = camera.fx_px * by_distortion.row(0);
  d.row(1).tail<8>() = camera.fy_px * by_distortion.row(1);
  return d;
}

}  // namespace sextant
