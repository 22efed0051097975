// SPDX-License-Identifier: Apache-2.0
#include "geometry/intrinsics.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/distortion.h"
#include "geometry/lens.h"

namespace sextant {
namespace {

using ByDistortion = Eigen::Matrix<double, 2, 8>;

// Derivative of the point of DistortPlane by its first eight coefficients; the equations are in
// distortion.h.
ByDistortion PlaneByCoefficients(const Camera& camera, const Eigen::Vector2d& m) {
  const auto& k = camera.distortion;
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

// A tilted sensor sees the distorted point through a homography, which depends on the point alone.
ByDistortion BrownByCoefficients(const Camera& camera, const Eigen::Vector2d& m) {
  const ByDistortion on_plane = PlaneByCoefficients(camera, m);
  const double tau_x = camera.distortion[12];
  const double tau_y = camera.distortion[13];
  if (tau_x == 0.0 && tau_y == 0.0) return on_plane;
  Camera upright = camera;
  upright.distortion[12] = upright.distortion[13] = 0.0;
  const std::optional<Distorted> before = DistortPlane(upright, m);
  if (!before) return ByDistortion::Zero();
  const Eigen::Matrix3d h = TiltHomography(tau_x, tau_y);
  const Eigen::Vector3d tilted = h * before->point.homogeneous();
  const Eigen::Matrix2d by_point =
      (h.topLeftCorner<2, 2>() - tilted.hnormalized() * h.bottomLeftCorner<1, 2>()) / tilted.z();
  return by_point * on_plane;
}

ByDistortion OmnidirectionalByCoefficients(const Camera& camera, const Eigen::Vector3d& point) {
  const double depth = point.z() + camera.xi * point.norm();
  ByDistortion d = PlaneByCoefficients(camera, point.head<2>() / depth);
  d.rightCols<3>().setZero();
  return d;
}

ByDistortion EquidistantByCoefficients(const Eigen::Vector3d& point) {
  ByDistortion d = ByDistortion::Zero();
  const double r = point.head<2>().norm();
  if (r == 0.0) return d;
  const double theta = std::atan2(r, point.z());
  double power = theta;
  for (int i = 0; i < 4; ++i) {
    power *= theta * theta;
    d.col(i) = power / r * point.head<2>();
  }
  return d;
}

ByDistortion ByCoefficients(const Camera& camera, const Eigen::Vector3d& point) {
  switch (camera.model) {
    case CameraModel::kPinhole:
    case CameraModel::kDoubleSphere:
      break;
    case CameraModel::kBrownConrady:
      return BrownByCoefficients(camera, point.hnormalized());
    case CameraModel::kEquidistant:
      return EquidistantByCoefficients(point);
    case CameraModel::kOmnidirectional:
      return OmnidirectionalByCoefficients(camera, point);
  }
  return ByDistortion::Zero();
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

Camera WithImageSize(const Camera& camera, int width_px, int height_px) {
  Camera changed = camera;
  changed.width_px = width_px;
  changed.height_px = height_px;
  return changed;
}

std::span<const double> WrittenDistortion(const Camera& camera) {
  const std::span<const double> all = camera.distortion;
  const std::span<const double> beyond = all.subspan(kIntrinsicCount - kFirstDistortion);
  const bool is_usual =
      std::all_of(beyond.begin(), beyond.end(), [](double k) { return k == 0.0; });
  return is_usual ? all.first(kIntrinsicCount - kFirstDistortion) : all;
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
  const std::optional<LensImage> image = ProjectThroughLens(camera, point_in_cam);
  if (!image) return std::nullopt;
  Eigen::Matrix<double, 2, kIntrinsicCount> d = Eigen::Matrix<double, 2, kIntrinsicCount>::Zero();
  d(0, 0) = image->point.x();
  d(1, 1) = image->point.y();
  d.block<2, 2>(0, 2).setIdentity();
  if (camera.model == CameraModel::kPinhole) return d;
  d.rightCols<8>() = PixelByImage(camera) * ByCoefficients(camera, point_in_cam);
  return d;
}

}  // namespace sextant
