// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/correspondences.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/so3.h"
#include "geometry/symmetric.h"

namespace sextant {

Expected<Correspondences> PrepareCorrespondences(std::span<const Eigen::Vector2d> image_points,
                                                 std::span<const Eigen::Vector3d> points,
                                                 std::size_t min_points) {
  if (points.size() < min_points) {
    return MakeError(
        ErrorCode::kTooFewPairs,
        fmt::format("expected at least {} 2D-3D pairs, got {}", min_points, points.size()));
  }
  SEXTANT_ASSIGN_OR_RETURN(const PointCloudFrame frame,
                           FramePointCloud(points, static_cast<int>(min_points)));
  SEXTANT_ASSIGN_OR_RETURN(const ImageMoments moments,
                           ComputeImageMoments(image_points, points, frame));
  return Correspondences{image_points, points, frame, moments};
}

ImageFit FitOf(const Correspondences& data, const Eigen::Matrix3d& rotation,
               const Eigen::Vector3d& centroid_in_cam) {
  return FitOf(data.image_points, data.points, rotation,
               centroid_in_cam - rotation * data.frame.centroid);
}

void PolishIfExact(const Correspondences& data, const ImageFit& fit, Eigen::Matrix3d& rotation,
                   Eigen::Vector3d& centroid_in_cam) {
  // Residuals of 1e-5 of the extent of the image: a few thousandths of a pixel.
  constexpr double kExact = 1e-10;
  const auto count = static_cast<double>(data.points.size());
  if (fit.behind > 0 || !(fit.sum_squares < kExact * count * data.moments.Spread())) return;
  Matrix6d normal = Matrix6d::Zero();
  Vector6d right = Vector6d::Zero();
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    const Eigen::Vector3d arm = rotation * (data.points[i] - data.frame.centroid);
    const Eigen::Vector3d in_cam = arm + centroid_in_cam;
    Eigen::Matrix<double, 2, 6> jacobian;
    for (int axis = 0; axis < 2; ++axis) {
      Eigen::Vector3d by_point = Eigen::Vector3d::Unit(axis);
      by_point.z() = -data.image_points[i](axis);
      jacobian.row(axis) << arm.cross(by_point).transpose(), by_point.transpose();
    }
    normal += jacobian.transpose() * jacobian;
    right -= jacobian.transpose() * (in_cam.head<2>() - in_cam.z() * data.image_points[i]);
  }
  const Vector6d step = SolveSymmetric(normal, right);
  if (!step.allFinite()) return;
  rotation = ExpSo3(step.head<3>()) * rotation;
  centroid_in_cam += step.tail<3>();
}

std::array<std::size_t, 3> WidestTriangle(const Correspondences& data) {
  const auto count = static_cast<std::size_t>(std::min(data.frame.different_count, 4));
  std::array<std::size_t, 3> widest{};
  double largest = -1.0;
  for (std::size_t first = 0; first < count; ++first) {
    const auto at = [&](std::size_t k) { return data.frame.different[(first + k) % count]; };
    const Eigen::Vector3d edge = data.points[at(1)] - data.points[at(0)];
    const double area = edge.cross(data.points[at(2)] - data.points[at(0)]).squaredNorm();
    if (area > largest) {
      largest = area;
      widest = {at(0), at(1), at(2)};
    }
  }
  return widest;
}

TrianglePoses PosesOfWidestTriangle(const Correspondences& data) {
  const std::array<std::size_t, 3> widest = WidestTriangle(data);
  std::array<Eigen::Vector3d, 3> rays;
  std::array<Eigen::Vector3d, 3> points;
  for (std::size_t i = 0; i < 3; ++i) {
    rays[i] = data.image_points[widest[i]].homogeneous().normalized();
    points[i] = data.points[widest[i]];
  }
  TrianglePoses found;
  found.count = SolveP3p(rays, points, found.poses);
  return found;
}

double MirrorRatio(std::size_t count) {
  if (count <= 3) return std::numeric_limits<double>::infinity();
  const double freedom = 2.0 * static_cast<double>(count) - 6.0;
  return std::pow(25.0, 1.0 + 6.0 / freedom);
}

tl::unexpected<Error> MirroredError() {
  return MakeError(ErrorCode::kMirrored,
                   "points behind the camera, or a mirror image of them, fit the pixels far better "
                   "than any pose in front of it; check the signs of the axes");
}

tl::unexpected<Error> UnexplainedError() {
  return MakeError(ErrorCode::kNoConsensus,
                   "no pose with the points in front of the camera explains their pixels better "
                   "than a single pixel would; check which pixel belongs to which point");
}

}  // namespace sextant
