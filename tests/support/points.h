// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "geometry/random_vectors.h"
#include "geometry/rigid3d.h"

namespace sextant::test {

inline std::vector<Eigen::Vector3d> NormalPoints(int count, Random& random) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) points.push_back(NormalVector(random));
  return points;
}

inline std::vector<Eigen::Vector3d> Moved(const Rigid3d& b_from_a,
                                          const std::vector<Eigen::Vector3d>& points) {
  std::vector<Eigen::Vector3d> moved;
  for (const Eigen::Vector3d& p : points) moved.push_back(b_from_a * p);
  return moved;
}

}  // namespace sextant::test
