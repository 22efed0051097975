// SPDX-License-Identifier: Apache-2.0
#include "geometry/lens.h"

#include <Eigen/Geometry>

#include "geometry/distortion.h"
#include "geometry/fisheye.h"
#include "geometry/sphere_models.h"

namespace sextant {
namespace {

// (x/z, y/z), then the distortion of that plane.
std::optional<LensImage> ProjectPlane(const Camera& camera, const Eigen::Vector3d& point) {
  if (!(point.z() > 0.0)) return std::nullopt;
  const double inverse_depth = 1.0 / point.z();
  const Eigen::Vector2d undistorted = point.head<2>() / point.z();
  const std::optional<Distorted> distorted = Distort(camera, undistorted);
  if (!distorted) return std::nullopt;
  LensImage image;
  image.point = distorted->point;
  const Eigen::Matrix2d by_plane = inverse_depth * distorted->by_undistorted;
  image.by_point << by_plane, -(by_plane * undistorted);
  return image;
}

}  // namespace

std::optional<LensImage> ProjectThroughLens(const Camera& camera,
                                            const Eigen::Vector3d& point_in_cam) {
  switch (camera.model) {
    case CameraModel::kPinhole:
    case CameraModel::kBrownConrady:
      return ProjectPlane(camera, point_in_cam);
    case CameraModel::kEquidistant:
      return ProjectFisheye(camera, point_in_cam);
    case CameraModel::kOmnidirectional:
      return ProjectOmnidirectional(camera, point_in_cam);
    case CameraModel::kDoubleSphere:
      return ProjectDoubleSphere(camera, point_in_cam);
  }
  return std::nullopt;
}

std::optional<Eigen::Vector3d> RayThroughLens(const Camera& camera, const Eigen::Vector2d& image) {
  switch (camera.model) {
    case CameraModel::kPinhole:
      return image.homogeneous().normalized();
    case CameraModel::kBrownConrady:
      if (const auto undistorted = UndistortPlane(camera, image)) {
        return undistorted->homogeneous().normalized();
      }
      return std::nullopt;
    case CameraModel::kEquidistant:
      return RayOfFisheye(camera, image);
    case CameraModel::kOmnidirectional:
      return RayOfOmnidirectional(camera, image);
    case CameraModel::kDoubleSphere:
      return RayOfDoubleSphere(camera, image);
  }
  return std::nullopt;
}

}  // namespace sextant
