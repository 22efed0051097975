// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/point_cloud.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

/// A cloud has each optional column whole or not at all, and a point is finite or NaN throughout.
inline void CheckCloud(const Expected<PointCloud>& cloud) {
  CheckOutcome(cloud);
  if (!cloud) return;
  const std::size_t size = cloud->points.size();
  for (const std::size_t column :
       {cloud->intensity.size(), cloud->ring.size(), cloud->time_s.size()}) {
    if (column != 0 && column != size) Fault("a column of another length than the points");
  }
  for (const Eigen::Vector3d& point : cloud->points) {
    if (!point.allFinite() && !point.array().isNaN().all()) Fault("a point that is half finite");
  }
}

}  // namespace sextant::test
