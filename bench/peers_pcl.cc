// SPDX-License-Identifier: Apache-2.0
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/registration/correspondence_rejection_sample_consensus.h>
#include <pcl/registration/gicp.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/transformation_estimation_svd.h>

#include <memory>

#include "bench/peer_tasks.h"

namespace sextant::bench {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

Cloud::Ptr ToCloud(const std::vector<Eigen::Vector3d>& points) {
  Cloud::Ptr cloud(new Cloud);
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector3f f = point.cast<float>();
    cloud->emplace_back(f.x(), f.y(), f.z());
  }
  return cloud;
}

Rigid3d ToRigid(const Eigen::Matrix4f& matrix) {
  const Eigen::Matrix4d m = matrix.cast<double>();
  const Eigen::Matrix3d rotation = m.topLeftCorner<3, 3>();
  return {Eigen::Quaterniond(rotation).normalized(), m.topRightCorner<3, 1>()};
}

PeerCall Svd(const PointProblem& problem) {
  return [target = ToCloud(problem.in_cam),
          source = ToCloud(problem.in_lidar)]() -> std::optional<Rigid3d> {
    Eigen::Matrix4f matrix;
    pcl::registration::TransformationEstimationSVD<pcl::PointXYZ, pcl::PointXYZ>()
        .estimateRigidTransformation(*source, *target, matrix);
    return ToRigid(matrix);
  };
}

// RANSAC, then least squares on its inliers; PCL's own refinement uses the variance of the
// distances.
PeerCall Sac(const PointProblem& problem) {
  auto pairs = std::make_shared<pcl::Correspondences>();
  for (std::size_t i = 0; i < problem.in_cam.size(); ++i) {
    const int index = static_cast<int>(i);
    pairs->emplace_back(index, index, 0.0F);
  }
  return [target = ToCloud(problem.in_cam), source = ToCloud(problem.in_lidar), pairs,
          threshold = 3.37 * problem.sigma_m]() -> std::optional<Rigid3d> {
    pcl::registration::CorrespondenceRejectorSampleConsensus<pcl::PointXYZ> rejector;
    rejector.setInputSource(source);
    rejector.setInputTarget(target);
    rejector.setInlierThreshold(threshold);
    rejector.setMaximumIterations(100000);
    pcl::Correspondences inliers;
    rejector.getRemainingCorrespondences(*pairs, inliers);
    if (inliers.size() < 3) return std::nullopt;
    Eigen::Matrix4f matrix;
    pcl::registration::TransformationEstimationSVD<pcl::PointXYZ, pcl::PointXYZ>()
        .estimateRigidTransformation(*source, *target, inliers, matrix);
    return ToRigid(matrix);
  };
}

template <class Icp>
Prepare Iterative(double max_distance_m) {
  return [max_distance_m](const PointProblem& problem) -> PeerCall {
    return [target = ToCloud(problem.in_cam), source = ToCloud(problem.in_lidar),
            max_distance_m]() -> std::optional<Rigid3d> {
      Icp icp;
      icp.setInputTarget(target);
      icp.setInputSource(source);
      icp.setMaxCorrespondenceDistance(max_distance_m);
      icp.setMaximumIterations(100);
      Cloud aligned;
      icp.align(aligned);
      return ToRigid(icp.getFinalTransformation());
    };
  };
}

}  // namespace

void RegisterPcl() {
  RegisterPairs("pcl_svd", Svd);
  RegisterOutliers("pcl_sac", Sac);
  using Icp = pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ>;
  using Gicp = pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ>;
  RegisterCorners("pcl_icp", Iterative<Icp>(1.0));
  RegisterRooms("pcl_icp", Iterative<Icp>(0.5));
  RegisterRooms("pcl_gicp", Iterative<Gicp>(0.5));
}

}  // namespace sextant::bench
