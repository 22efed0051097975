// SPDX-License-Identifier: Apache-2.0
#include "features/camera/undistortion.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "geometry/distortion.h"

namespace sextant {

std::optional<Undistortion::Point> Undistortion::Undistort(const Eigen::Vector2d& pixel) const {
  if (!camera_ || camera_->model == CameraModel::kPinhole) {
    return Point{.straight_px = pixel, .straight_by_pixel = Eigen::Matrix2d::Identity()};
  }
  const std::optional<Eigen::Vector3d> ray = Unproject(*camera_, pixel);
  if (!ray || !(ray->z() > 0.0)) return std::nullopt;
  const Eigen::Matrix2d pixel_by_image = PixelByImage(*camera_);
  const Eigen::Vector2d centre(camera_->cx_px, camera_->cy_px);
  const Eigen::Vector2d undistorted = ray->hnormalized();
  const std::optional<Distorted> distorted = sextant::Distort(*camera_, undistorted);
  if (!distorted) return std::nullopt;
  return Point{.straight_px = pixel_by_image * undistorted + centre,
               .straight_by_pixel =
                   pixel_by_image * distorted->by_undistorted.inverse() * pixel_by_image.inverse()};
}

std::optional<Undistortion::Point> Undistortion::UndistortNear(const Eigen::Vector2d& pixel,
                                                               const Eigen::Vector2d& near_px,
                                                               const Point& near) const {
  if (!camera_ || camera_->model == CameraModel::kPinhole) return Undistort(pixel);
  // A Newton step of s leaves an error of s^2 times half the lens's curvature, at most 0.01 per px.
  constexpr double kShortStep_px = 0.1;
  constexpr int kMaxSteps = 3;
  Point point{.straight_px = near.straight_px + near.straight_by_pixel * (pixel - near_px),
              .straight_by_pixel = near.straight_by_pixel};
  for (int i = 0; i < kMaxSteps; ++i) {
    const std::optional<DistortedPoint> distorted = Distort(point.straight_px);
    if (!distorted) break;
    point.straight_by_pixel = distorted->pixel_by_straight.inverse();
    const Eigen::Vector2d step = point.straight_by_pixel * (pixel - distorted->pixel);
    point.straight_px += step;
    if (step.squaredNorm() < kShortStep_px * kShortStep_px) return point;
  }
  return Undistort(pixel);
}

std::optional<Undistortion::DistortedPoint> Undistortion::Distort(
    const Eigen::Vector2d& straight_px) const {
  if (!camera_ || camera_->model == CameraModel::kPinhole) {
    return DistortedPoint{.pixel = straight_px, .pixel_by_straight = Eigen::Matrix2d::Identity()};
  }
  const Eigen::Matrix2d pixel_by_image = PixelByImage(*camera_);
  const Eigen::Matrix2d image_by_pixel = pixel_by_image.inverse();
  const Eigen::Vector2d centre(camera_->cx_px, camera_->cy_px);
  const std::optional<Distorted> distorted =
      sextant::Distort(*camera_, image_by_pixel * (straight_px - centre));
  if (!distorted) return std::nullopt;
  return DistortedPoint{
      .pixel = pixel_by_image * distorted->point + centre,
      .pixel_by_straight = pixel_by_image * distorted->by_undistorted * image_by_pixel};
}

}  // namespace sextant
