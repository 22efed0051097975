// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "base/error.h"

namespace sextant {

enum class CameraModel {
  kPinhole,       ///< No distortion.
  kBrownConrady,  ///< k1 k2 p1 p2 k3 k4 k5 k6 (OpenCV's order; rational when k4..k6 are set).
  kEquidistant,   ///< Fisheye, k1 k2 k3 k4 (Kannala and Brandt 2006, OpenCV's `fisheye`).
};

/// Intrinsics. Pixel (0, 0) is the centre of the top-left pixel. Camera frame: x right, y down,
/// z forward.
///
/// Domain: points in front of the camera (z > 0, so less than 90 degrees from the axis also for a
/// fisheye), up to the radius at which the distorted image first stops growing. Beyond it two
/// points share a pixel and the polynomial is meaningless. Equations: geometry/distortion.h.
struct Camera {
  CameraModel model = CameraModel::kPinhole;
  int width_px = 0;   ///< 0 where unknown.
  int height_px = 0;  ///< 0 where unknown.
  double fx_px = 0.0;
  double fy_px = 0.0;
  double cx_px = 0.0;
  double cy_px = 0.0;
  std::array<double, 8> distortion{};  ///< Unused entries are zero.
};

/// Errors: kNonFinite; kInvalidInput for focal lengths that are not positive, a negative image
/// size, distortion of a pinhole, and distortion that folds near the centre: within half of the
/// shorter half side of the image, or within 0.05 rad of the axis where the image size is unknown.
Expected<void> ValidateCamera(const Camera& camera);

/// Pixel of a point in the camera frame [m]; none for a point behind the camera or where the
/// distortion has folded over (outside the model's domain).
std::optional<Eigen::Vector2d> Project(const Camera& camera, const Eigen::Vector3d& point_in_cam);

/// As Project, with the 2x3 derivative of the pixel by the point.
struct ProjectionWithJacobian {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> pixel_by_point;
};
std::optional<ProjectionWithJacobian> ProjectWithJacobian(const Camera& camera,
                                                          const Eigen::Vector3d& point_in_cam);

/// Unit ray in the camera frame through a pixel, by Newton's method on the distortion to rounding;
/// none for a pixel outside the image of the model's domain.
std::optional<Eigen::Vector3d> Unproject(const Camera& camera, const Eigen::Vector2d& pixel);

}  // namespace sextant
