// SPDX-License-Identifier: Apache-2.0
#include "geometry/camera.h"

#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/lens.h"
#include "geometry/lens_domain.h"

namespace sextant {
namespace {

bool IsFinite(const Camera& camera) {
  return std::isfinite(camera.fx_px) && std::isfinite(camera.fy_px) &&
         std::isfinite(camera.cx_px) && std::isfinite(camera.cy_px) &&
         std::isfinite(camera.skew_px) && std::isfinite(camera.xi) && std::isfinite(camera.alpha) &&
         std::all_of(camera.distortion.begin(), camera.distortion.end(),
                     [](double k) { return std::isfinite(k); });
}

// Distance from the axis, in focal lengths, within which a usable model must not fold.
double RadiusToCover(const Camera& camera) {
  constexpr double kWithoutImageSize = 0.05;
  const int shorter_px = std::min(camera.width_px, camera.height_px);
  if (shorter_px == 0) return kWithoutImageSize;
  const double radius = 0.25 * shorter_px / std::max(camera.fx_px, camera.fy_px);
  const bool is_angle = camera.model == CameraModel::kEquidistant;
  return is_angle ? std::min(radius, 0.5 * std::numbers::pi) : radius;
}

Eigen::Vector2d PixelOf(const Camera& camera, const Eigen::Vector2d& image) {
  return {camera.fx_px * image.x() + camera.skew_px * image.y() + camera.cx_px,
          camera.fy_px * image.y() + camera.cy_px};
}

// The numbers that are not the distortion's.
Expected<void> CheckShape(const Camera& camera) {
  const bool has_xi =
      camera.model == CameraModel::kOmnidirectional || camera.model == CameraModel::kDoubleSphere;
  const bool has_alpha = camera.model == CameraModel::kDoubleSphere;
  const double least_xi = has_alpha ? -1.0 : 0.0;
  if (has_xi ? !(camera.xi >= least_xi && (!has_alpha || camera.xi > -1.0)) : camera.xi != 0.0) {
    return MakeError(
        ErrorCode::kInvalidInput,
        fmt::format("the camera has xi = {}, expected {}", camera.xi,
                    !has_xi ? "0: only the omnidirectional and double-sphere models have it"
                            : (has_alpha ? "more than -1" : "0 or more")));
  }
  if (has_alpha ? !(camera.alpha >= 0.0 && camera.alpha <= 1.0) : camera.alpha != 0.0) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("the camera has alpha = {}, expected {}", camera.alpha,
                                 has_alpha ? "0 to 1" : "0: only the double-sphere model has it"));
  }
  if (camera.model == CameraModel::kPinhole && camera.skew_px != 0.0) {
    return MakeError(ErrorCode::kInvalidInput,
                     "the camera is a pinhole with skew, which it would ignore; set the model to "
                     "Brown-Conrady, with or without distortion");
  }
  return {};
}

// A flat lens of a shorter focal length would see 178 degrees; no lens of another model has one.
constexpr double kMinFocalPerWidth = 0.02;

// The coefficients of Camera::distortion that a model has are the first ones.
std::size_t CoefficientsOf(CameraModel model) {
  switch (model) {
    case CameraModel::kPinhole:
    case CameraModel::kDoubleSphere:
      return 0;
    case CameraModel::kEquidistant:
      return 4;
    case CameraModel::kOmnidirectional:
      return 5;
    case CameraModel::kBrownConrady:
      break;
  }
  return kMaxDistortion;
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
  if (camera.fx_px < kMinFocalPerWidth * camera.width_px) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("the focal length is {} px in an image {} px wide? Intrinsics are "
                                 "in pixels: divide millimetres by the size of a pixel, multiply "
                                 "shares of the image by its width and height",
                                 camera.fx_px, camera.width_px));
  }
  const auto beyond =
      camera.distortion.begin() + static_cast<std::ptrdiff_t>(CoefficientsOf(camera.model));
  const bool is_ignored =
      std::any_of(beyond, camera.distortion.end(), [](double k) { return k != 0.0; });
  if (camera.model == CameraModel::kPinhole && is_ignored) {
    return MakeError(ErrorCode::kInvalidInput,
                     "the camera is a pinhole with distortion coefficients, which it would "
                     "ignore; set the model to Brown-Conrady or equidistant, or them to 0");
  }
  if (is_ignored) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("the camera has more distortion coefficients than the {} of its "
                                 "model; set the model to Brown-Conrady, or them to 0",
                                 CoefficientsOf(camera.model)));
  }
  SEXTANT_RETURN_IF_ERROR(CheckShape(camera));
  if (const double radius = RadiusToCover(camera); !GrowsUpTo(camera, radius)) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("the camera's distortion folds the image within {:.3g} focal "
                                 "lengths of its centre ({}); check the order and signs of the "
                                 "coefficients",
                                 radius, DomainText(camera)));
  }
  return {};
}

std::optional<Eigen::Vector2d> Project(const Camera& camera, const Eigen::Vector3d& point_in_cam) {
  if (camera.model == CameraModel::kPinhole) {
    if (!(point_in_cam.z() > 0.0)) return std::nullopt;
    return PixelOf(camera, point_in_cam.head<2>() / point_in_cam.z());
  }
  const std::optional<LensImage> image = ProjectThroughLens(camera, point_in_cam);
  if (!image) return std::nullopt;
  return PixelOf(camera, image->point);
}

std::optional<ProjectionWithJacobian> ProjectWithJacobian(const Camera& camera,
                                                          const Eigen::Vector3d& point_in_cam) {
  const std::optional<LensImage> image = ProjectThroughLens(camera, point_in_cam);
  if (!image) return std::nullopt;
  return ProjectionWithJacobian{PixelOf(camera, image->point),
                                PixelByImage(camera) * image->by_point};
}

std::optional<Eigen::Vector3d> Unproject(const Camera& camera, const Eigen::Vector2d& pixel) {
  const double y = (pixel.y() - camera.cy_px) / camera.fy_px;
  const double x = (pixel.x() - camera.cx_px - camera.skew_px * y) / camera.fx_px;
  return RayThroughLens(camera, {x, y});
}

}  // namespace sextant
