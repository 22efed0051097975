// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <opengv/point_cloud/PointCloudAdapter.hpp>
#include <opengv/point_cloud/methods.hpp>
#include <opengv/sac/Ransac.hpp>
#include <opengv/sac_problems/point_cloud/PointCloudSacProblem.hpp>

#include "bench/peer_tasks.h"

namespace sextant::bench {
namespace {

// opengv estimates the pose of the second frame in the first.
struct Points {
  explicit Points(const PointProblem& problem)
      : in_cam(problem.in_cam.begin(), problem.in_cam.end()),
        in_lidar(problem.in_lidar.begin(), problem.in_lidar.end()),
        adapter(in_cam, in_lidar) {}

  opengv::points_t in_cam;
  opengv::points_t in_lidar;
  opengv::point_cloud::PointCloudAdapter adapter;
};

Rigid3d ToRigid(const opengv::transformation_t& transformation) {
  const Eigen::Matrix3d rotation = transformation.leftCols<3>();
  return {Eigen::Quaterniond(rotation), transformation.col(3)};
}

}  // namespace

void RegisterOpengv() {
  RegisterPairs("opengv_arun", [](const PointProblem& problem) -> PeerCall {
    return [points = std::make_shared<Points>(problem)]() -> std::optional<Rigid3d> {
      return ToRigid(opengv::point_cloud::threept_arun(points->adapter));
    };
  });
  RegisterOutliers("opengv_ransac", [](const PointProblem& problem) -> PeerCall {
    using Sac = opengv::sac_problems::point_cloud::PointCloudSacProblem;
    const auto points = std::make_shared<Points>(problem);
    const double threshold = 3.37 * problem.sigma_m;
    return [points, threshold]() -> std::optional<Rigid3d> {
      const auto sac = std::make_shared<Sac>(points->adapter, /*randomSeed=*/false);
      opengv::sac::Ransac<Sac> ransac;
      ransac.sac_model_ = sac;
      ransac.threshold_ = threshold;
      ransac.max_iterations_ = 100000;
      if (!ransac.computeModel()) return std::nullopt;
      opengv::transformation_t refined;
      sac->optimizeModelCoefficients(ransac.inliers_, ransac.model_coefficients_, refined);
      return ToRigid(refined);
    };
  });
}

}  // namespace sextant::bench
