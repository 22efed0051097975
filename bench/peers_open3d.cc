// SPDX-License-Identifier: Apache-2.0
#include <open3d/geometry/KDTreeSearchParam.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/pipelines/registration/GeneralizedICP.h>
#include <open3d/pipelines/registration/Registration.h>
#include <open3d/pipelines/registration/TransformationEstimation.h>

#include <memory>

#include "bench/peer_tasks.h"

namespace sextant::bench {
namespace {

namespace reg = open3d::pipelines::registration;
using Cloud = open3d::geometry::PointCloud;

std::shared_ptr<Cloud> ToCloud(const std::vector<Eigen::Vector3d>& points) {
  return std::make_shared<Cloud>(points);
}

reg::CorrespondenceSet AllPairs(std::size_t count) {
  reg::CorrespondenceSet pairs;
  for (std::size_t i = 0; i < count; ++i)
    pairs.emplace_back(static_cast<int>(i), static_cast<int>(i));
  return pairs;
}

Rigid3d ToRigid(const Eigen::Matrix4d& matrix) {
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  return {Eigen::Quaterniond(rotation).normalized(), matrix.topRightCorner<3, 1>()};
}

PeerCall Closed(const PointProblem& problem) {
  return [target = ToCloud(problem.in_cam), source = ToCloud(problem.in_lidar),
          pairs = AllPairs(problem.in_cam.size())]() -> std::optional<Rigid3d> {
    return ToRigid(
        reg::TransformationEstimationPointToPoint().ComputeTransformation(*source, *target, pairs));
  };
}

PeerCall Ransac(const PointProblem& problem) {
  return [target = ToCloud(problem.in_cam), source = ToCloud(problem.in_lidar),
          pairs = AllPairs(problem.in_cam.size()),
          threshold = 3.37 * problem.sigma_m]() -> std::optional<Rigid3d> {
    const reg::RegistrationResult result = reg::RegistrationRANSACBasedOnCorrespondence(
        *source, *target, pairs, threshold, reg::TransformationEstimationPointToPoint(false), 3, {},
        reg::RANSACConvergenceCriteria(100000, 0.999));
    if (result.correspondence_set_.size() < 3) return std::nullopt;
    return ToRigid(result.transformation_);
  };
}

PeerCall PointToPoint(const PointProblem& problem, double max_distance_m) {
  return [target = ToCloud(problem.in_cam), source = ToCloud(problem.in_lidar),
          max_distance_m]() -> std::optional<Rigid3d> {
    return ToRigid(reg::RegistrationICP(*source, *target, max_distance_m, LocalStart().Matrix(),
                                        reg::TransformationEstimationPointToPoint(),
                                        reg::ICPConvergenceCriteria(1e-9, 1e-9, 100))
                       .transformation_);
  };
}

// Includes computing the normals, as the input is two plain scans.
PeerCall PointToPlane(const PointProblem& problem) {
  return [&problem]() -> std::optional<Rigid3d> {
    const std::shared_ptr<Cloud> target = ToCloud(problem.in_cam);
    const std::shared_ptr<Cloud> source = ToCloud(problem.in_lidar);
    target->EstimateNormals(open3d::geometry::KDTreeSearchParamKNN(20));
    return ToRigid(reg::RegistrationICP(*source, *target, 0.5, LocalStart().Matrix(),
                                        reg::TransformationEstimationPointToPlane(),
                                        reg::ICPConvergenceCriteria(1e-9, 1e-9, 100))
                       .transformation_);
  };
}

}  // namespace

void RegisterOpen3d() {
  RegisterPairs("open3d", Closed);
  RegisterOutliers("open3d_ransac", Ransac);
  RegisterCorners("open3d_icp", [](const PointProblem& p) { return PointToPoint(p, 1.0); });
  RegisterRooms("open3d_icp", [](const PointProblem& p) { return PointToPoint(p, 0.5); });
  RegisterRooms("open3d_plane", PointToPlane);
}

}  // namespace sextant::bench
