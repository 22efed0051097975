// SPDX-License-Identifier: Apache-2.0
#include "geometry/calibration_problem.h"

#include <algorithm>

namespace sextant {

PointSets PointsOf(std::span<const Pair3d3d> pairs) {
  PointSets sets;
  sets.in_cam.reserve(pairs.size());
  sets.in_lidar.reserve(pairs.size());
  for (const Pair3d3d& pair : pairs) {
    sets.in_cam.push_back(pair.point_in_cam);
    sets.in_lidar.push_back(pair.point_in_lidar);
  }
  return sets;
}

PointSets WithholdPairing(std::span<const Pair3d3d> pairs) {
  PointSets sets = PointsOf(pairs);
  const auto by_coordinates = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  };
  std::sort(sets.in_cam.begin(), sets.in_cam.end(), by_coordinates);
  std::sort(sets.in_lidar.begin(), sets.in_lidar.end(), by_coordinates);
  return sets;
}

}  // namespace sextant
