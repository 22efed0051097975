// SPDX-License-Identifier: Apache-2.0
#include "support/outliers.h"

#include <algorithm>
#include <cmath>

namespace sextant::test {

std::vector<int> AddOutliers(double share, const SceneOptions& options, Random& random,
                             PairScene& scene) {
  CalibrationProblem& problem = scene.problem;
  const int count = static_cast<int>(problem.pairs_3d3d.size());
  std::vector<int> outliers(static_cast<std::size_t>(std::lround(share * count)));
  random.Sample(count, outliers);
  for (const int i : outliers) {
    const auto index = static_cast<std::size_t>(i);
    for (int k = 0; k < 3; ++k) {
      const double centre = k == 2 ? options.depth_m : 0.0;
      problem.pairs_3d3d[index].point_in_cam[k] =
          centre + random.Uniform(-options.extent_m, options.extent_m);
    }
    problem.pairs_2d3d[index].pixel.x() = random.Uniform(0.0, problem.camera->width_px);
    problem.pairs_2d3d[index].pixel.y() = random.Uniform(0.0, problem.camera->height_px);
  }
  std::vector<int> inliers;
  for (int i = 0; i < count; ++i) {
    if (std::find(outliers.begin(), outliers.end(), i) == outliers.end()) inliers.push_back(i);
  }
  return inliers;
}

CalibrationProblem Only(const CalibrationProblem& problem, const std::vector<int>& indices) {
  CalibrationProblem only = problem;
  only.pairs_3d3d.clear();
  only.pairs_2d3d.clear();
  for (const int i : indices) {
    only.pairs_3d3d.push_back(problem.pairs_3d3d[static_cast<std::size_t>(i)]);
    only.pairs_2d3d.push_back(problem.pairs_2d3d[static_cast<std::size_t>(i)]);
  }
  return only;
}

}  // namespace sextant::test
