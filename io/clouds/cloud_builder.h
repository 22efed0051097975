// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

#include "base/error.h"
#include "geometry/point_cloud.h"
#include "io/clouds/cloud_columns.h"

namespace sextant {

/// Gathers the rows of a table of points as a PointCloud.
class CloudBuilder {
 public:
  explicit CloudBuilder(const CloudColumns& columns) : columns_(columns) {}

  /// Of the point's row, the number in a column that `columns` names.
  using Value = std::function<double(std::size_t column)>;

  /// Adds a point. One with a coordinate that is not finite is a ray without a return: all NaN, its
  /// ring and time kept where they make sense.
  /// Errors, which name neither file nor row: kParse for a ring that is no whole number of 16 bits,
  /// kNonFinite for a time that is none.
  Expected<void> Add(const Value& value);

  std::size_t size() const { return cloud_.points.size(); }

  /// The cloud. Times that are negative or longer ago than any scan lasts (1000 s; since 1970, say)
  /// are counted from the first point; rings are ordered by OrderRings.
  PointCloud Finish() &&;

 private:
  CloudColumns columns_;
  PointCloud cloud_;
};

/// Numbers the rings by elevation, 0 the lowest, where the sensor numbers them from above (Ouster)
/// or in the order of firing (Velodyne's laser_id). Rings that already ascend stay as they are,
/// gaps included; so do fewer than two.
void OrderRings(PointCloud& cloud);

}  // namespace sextant
