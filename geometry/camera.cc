// SPDX-License-Identifier: Apache-2.0
#include "geometry/camera.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/distortion.h"

namespace sextant {
namespace {

constexpr double kHalfPi = 0.5 * std::numbers::pi;

bool IsFinite(const Camera& camera) {
  return std::isfinite(camera.fx_px) && std::isfinite(camera.fy_px) &&
         std::isfinite(camera.cx_px) && std::isfinite(camera.cy_px) &&
         std::all_of(camera.distortion.begin(), camera.distortion.end(),
                     [](double k) { return std::isfinite(k); });
}

// Distance from the axis, in focal lengths, within which a usable model must not fold.
double RadiusToCover(const Camera& camera) {
  constexpr double kWithoutImageSize = 0.05;
  const int shorter_px = std::min(camera.width_px, camera.height_px);
  if (shorter_px == 0) return kWithoutImageSize;
  const double radius = 0.25 * shorter_px / std::max(camera.fx_px, camera.fy_px);
  return camera.model == CameraModel::kEquidistant ? std::min(radius, kHalfPi) : radius;
}

Eigen::Vector2d PixelOf(const Camera& camera, const Eigen::Vector2d& distorted) {
  return {camera.fx_px * distorted.x() + camera.cx_px, camera.fy_px * distorted.y() + camera.cy_px};
}

// Newton's method with step halving. The image of the domain is star-shaped about the axis, so
// from there each step can reduce the residual, unless the target lies outside.
std::optional<Eigen::Vector2d> UndistortPlane(const Camera& camera, const Eigen::Vector2d& target) {
  constexpr int kMaxSteps = 100;
  constexpr double kMinFraction = 1e-6;
  constexpr double kLastStep = 1e-9;
  Eigen::Vector2d guess = target;
  std::optional<Distorted> image = Distort(camera, guess);
  if (!image) {
    guess.setZero();
    image = Distort(camera, guess);
  }
  const double rounding = 1e-15 * (1.0 + target.norm());
  for (int step = 0; step < kMaxSteps && image; ++step) {
    const Eigen::Vector2d residual = target - image->point;
    if (residual.norm() <= rounding) return guess;
    const Eigen::Vector2d full = image->by_undistorted.inverse() * residual;
    // Newton's method squares its error: the next step would be rounding.
    if (full.norm() < kLastStep) return Distort(camera, guess + full) ? guess + full : guess;
    double fraction = 1.0;
    std::optional<Distorted> next;
    // NOLINTNEXTLINE(clang-analyzer-security.FloatLoopCounter): halved exactly.
    for (; fraction > kMinFraction; fraction *= 0.5) {
      next = Distort(camera, guess + fraction * full);
      if (next && (target - next->point).norm() < residual.norm()) break;
    }
    if (fraction <= kMinFraction) {
      // The residual is rounding, or the step ends at the border of the domain.
      return residual.norm() <= 1e3 * rounding ? std::optional(guess) : std::nullopt;
    }
    guess += fraction * full;
    image = next;
  }
  return std::nullopt;
}

// The angle from the axis whose distorted value is `target`; bisection guards the Newton steps.
std::optional<double> UndistortAngle(const Camera& camera, double target) {
  constexpr int kMaxSteps = 100;
  double low = 0.0;
  double high = kHalfPi;
  double theta = std::min(target, 0.5 * kHalfPi);
  for (int step = 0; step < kMaxSteps; ++step) {
    const std::optional<DistortedAngle> image = DistortAngle(camera, theta);
    const double missing = image ? target - image->value : -target;
    const double newton = image ? theta + missing / image->slope : high;
    if (image && std::abs(newton - theta) <= 1e-15) return newton;
    (missing < 0.0 ? high : low) = theta;
    theta = newton > low && newton < high ? newton : 0.5 * (low + high);
  }
  return std::nullopt;
}

}  // namespace

Expected<void> ValidateCamera(const Camera& camera) {
  if (!IsFinite(camera)) {
    return MakeError(ErrorCode::kNonFinite,
                     "the camera's intrinsics or distortion contain a NaN or infinite number");
  }
  if (!(camera.fx_px > 0.0 && camera.fy_px > 0.0)) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("the camera has focal lengths {} and {} px, expected both > 0",
                                 camera.fx_px, camera.fy_px));
  }
  if (camera.width_px < 0 || camera.height_px < 0) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("the camera's image is {} x {} px, expected positive, or 0 for "
                                 "unknown",
                                 camera.width_px, camera.height_px));
  }
  const bool is_distorted = std::any_of(camera.distortion.begin(), camera.distortion.end(),
                                        [](double k) { return k != 0.0; });
  if (camera.model == CameraModel::kPinhole && is_distorted) {
    return MakeError(ErrorCode::kInvalidInput,
                     "the camera is a pinhole with distortion coefficients, which it would "
                     "ignore; set the model to Brown-Conrady or equidistant, or them to 0");
  }
  if (const double radius = RadiusToCover(camera); !GrowsUpTo(camera, radius)) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("the camera's distortion folds the image within {:.3g} focal "
                                 "lengths of its centre; check the order and signs of the "
                                 "coefficients",
                                 radius));
  }
  return {};
}

std::optional<Eigen::Vector2d> Project(const Camera& camera, const Eigen::Vector3d& point_in_cam) {
  if (!(point_in_cam.z() > 0.0)) return std::nullopt;
  const Eigen::Vector2d undistorted = point_in_cam.head<2>() / point_in_cam.z();
  if (camera.model == CameraModel::kPinhole) return PixelOf(camera, undistorted);
  const std::optional<Distorted> distorted = Distort(camera, undistorted);
  if (!distorted) return std::nullopt;
  return PixelOf(camera, distorted->point);
}

std::optional<ProjectionWithJacobian> ProjectWithJacobian(const Camera& camera,
                                                          const Eigen::Vector3d& point_in_cam) {
  if (!(point_in_cam.z() > 0.0)) return std::nullopt;
  const double inverse_depth = 1.0 / point_in_cam.z();
  const Eigen::Vector2d undistorted = point_in_cam.head<2>() / point_in_cam.z();
  const std::optional<Distorted> distorted = Distort(camera, undistorted);
  if (!distorted) return std::nullopt;
  const Eigen::Vector2d focal(camera.fx_px, camera.fy_px);
  ProjectionWithJacobian result;
  result.pixel = PixelOf(camera, distorted->point);
  const Eigen::Matrix2d pixel_by_plane =
      inverse_depth * (focal.asDiagonal() * distorted->by_undistorted);
  result.pixel_by_point << pixel_by_plane, -(pixel_by_plane * undistorted);
  return result;
}

std::optional<Eigen::Vector3d> Unproject(const Camera& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d target((pixel.x() - camera.cx_px) / camera.fx_px,
                               (pixel.y() - camera.cy_px) / camera.fy_px);
  if (camera.model == CameraModel::kPinhole) return target.homogeneous().normalized();
  if (camera.model == CameraModel::kBrownConrady) {
    const std::optional<Eigen::Vector2d> undistorted = UndistortPlane(camera, target);
    if (!undistorted) return std::nullopt;
    return undistorted->homogeneous().normalized();
  }
  const double radius = target.norm();
  if (radius == 0.0) return Eigen::Vector3d::UnitZ();
  const std::optional<double> theta = UndistortAngle(camera, radius);
  if (!theta) return std::nullopt;
  Eigen::Vector3d ray;
  ray << std::sin(*theta) / radius * target, std::cos(*theta);
  return ray;
}

}  // namespace sextant
