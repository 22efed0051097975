// SPDX-License-Identifier: Apache-2.0
#include "eval/synthetic/mismatched_pairs.h"

#include <cmath>

namespace sextant {

int InlierCount(int pairs, double outlier_fraction) {
  return pairs - static_cast<int>(std::lround(outlier_fraction * pairs));
}

void MismatchPairs(const RandomSceneOptions& options, int inliers, Random& random,
                   RandomScene& scene) {
  const Rigid3d lidar_from_cam = scene.cam_from_lidar.Inverse();
  CalibrationProblem& problem = scene.problem;
  for (auto i = static_cast<std::size_t>(inliers); i < problem.pairs_3d3d.size(); ++i) {
    Eigen::Vector3d in_cam(0.0, 0.0, options.depth_m);
    for (int axis = 0; axis < 3; ++axis) {
      in_cam[axis] += random.Uniform(-options.extent_m, options.extent_m);
    }
    problem.pairs_3d3d[i].point_in_lidar = lidar_from_cam * in_cam;
    problem.pairs_2d3d[i].point_in_lidar = problem.pairs_3d3d[i].point_in_lidar;
  }
  problem.point_sets = WithholdPairing(problem.pairs_3d3d);
}

}  // namespace sextant
