// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "base/error.h"

namespace sextant {

enum class CameraModel {
  kPinhole,       ///< No distortion and no skew.
  kBrownConrady,  ///< k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 tau_x tau_y (OpenCV's order): rational
                  ///< where k4..k6 are set, with a thin prism (s) and a tilted sensor (tau [rad]).
  kEquidistant,   ///< Fisheye, k1 k2 k3 k4 (Kannala and Brandt 2006, OpenCV's `fisheye`).
  kOmnidirectional,  ///< Unified model (Mei and Rives 2007): xi, then k1 k2 p1 p2 k3.
  kDoubleSphere,     ///< xi and alpha (Usenko, Demmel and Cremers 2018); no distortion.
};

/// The number of coefficients of the longest model.
inline constexpr std::size_t kMaxDistortion = 14;

/// Intrinsics. Pixel (0, 0) is the centre of the top-left pixel. Camera frame: x right, y down,
/// z forward. A pixel is (fx x + skew y + cx, fy y + cy) for the image (x, y) in focal lengths,
/// whose equations are in geometry/lens.h and geometry/distortion.h.
///
/// Domain: pinhole and Brown-Conrady, points in front of the camera (z > 0); the wide models, also
/// points beyond 90 degrees from the axis. Each up to the radius at which the image first stops
/// growing: beyond it two points share a pixel and the polynomial is meaningless. A rational
/// distortion may have a pole before that radius, which ends it too (geometry/lens_domain.h).
struct Camera {
  CameraModel model = CameraModel::kPinhole;
  int width_px = 0;   ///< 0 where unknown.
  int height_px = 0;  ///< 0 where unknown.
  double fx_px = 0.0;
  double fy_px = 0.0;
  double cx_px = 0.0;
  double cy_px = 0.0;
  std::array<double, kMaxDistortion> distortion{};  ///< Unused entries are zero.
  double skew_px = 0.0;
  double xi = 0.0;     ///< Omnidirectional, >= 0; double sphere, > -1.
  double alpha = 0.0;  ///< Double sphere, 0 to 1.
};

/// Errors: kNonFinite; kInvalidInput for focal lengths that are not positive or below 0.02 widths
/// of the image, a negative image size, distortion or skew of a pinhole, xi or alpha of a model
/// that has none or out of range, and distortion that folds near the centre: within half of the
/// shorter half side of the image, or within 0.05 rad of the axis where the image size is unknown.
Expected<void> ValidateCamera(const Camera& camera);

/// Pixel of a point in the camera frame [m]; none outside the model's domain.
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

/// The derivative of a pixel by the image in focal lengths: [fx skew; 0 fy].
inline Eigen::Matrix2d PixelByImage(const Camera& camera) {
  Eigen::Matrix2d k;
  k << camera.fx_px, camera.skew_px, 0.0, camera.fy_px;
  return k;
}

}  // namespace sextant
