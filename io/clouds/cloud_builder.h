// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "base/error.h"
#include "geometry/point_cloud.h"
#include "io/clouds/cloud_columns.h"

namespace sextant {

/// The memory of a point that has every field of a PointCloud, in bytes.
inline constexpr std::size_t kMaxPointBytes =
    sizeof(Eigen::Vector3d) + sizeof(float) + sizeof(std::uint16_t) + sizeof(double);

/// Builds a PointCloud from the rows of a table. Time is linear in the rows; memory is that of the
/// cloud, at most kMaxPointBytes a row, and three times as much where `points` is not known.
class CloudBuilder {
 public:
  /// `points`: the expected number of rows, for which memory is reserved.
  explicit CloudBuilder(const CloudColumns& columns, std::size_t points = 0);

  /// Returns the number in a column of the current row; called only for columns in `columns`.
  using Value = std::function<double(std::size_t column)>;

  /// Adds a point. A point with a coordinate that is not finite, or beyond kMaxCoordinate_m, is a
  /// ray without a return: its coordinates become NaN; its ring and time are kept if they are
  /// valid. Errors, without file or row: kParse for a ring that is not a whole number from 0 to
  /// 65535, kNonFinite for a time that is not finite.
  Expected<void> Add(const Value& value);

  std::size_t size() const { return cloud_.points.size(); }

  /// The cloud. If any time is negative or exceeds 1000 s, the longest possible scan (times since
  /// 1970, for example), all times are counted from the earliest; beyond 1e11, 1e14 and 1e17 they
  /// are milliseconds, microseconds and nanoseconds. Rings keep their numbers.
  PointCloud Take() &&;
  /// As Take, with the rings ordered by OrderRings.
  PointCloud Finish() &&;

 private:
  CloudColumns columns_;
  PointCloud cloud_;
};

/// Refuses a scan in millimetres: no sensor measures as far as half of its points. Error:
/// kInvalidInput, without the file. Time is linear; memory 8 bytes a point.
Expected<void> CheckMetres(const PointCloud& cloud);

/// Numbers the rings by ascending elevation if the sensor numbers them from above (Ouster) or in
/// the order of firing (Velodyne's laser_id). Numbers that already ascend with elevation are kept,
/// gaps included, as is a single ring.
void OrderRings(PointCloud& cloud);

}  // namespace sextant
