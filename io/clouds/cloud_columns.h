// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string>

#include "base/error.h"

namespace sextant {

/// A column of a table of points: a field of PCD or PointCloud2, a property of PLY, a CSV column.
struct NamedColumn {
  std::string name;
  bool is_integer = false;  ///< Known of binary formats; integer times are in nanoseconds.
};

/// Which column of a table of points is taken for what; kNone where there is none.
struct CloudColumns {
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::size_t x = kNone;
  std::size_t y = kNone;
  std::size_t z = kNone;
  std::size_t intensity = kNone;
  std::size_t ring = kNone;
  std::size_t time = kNone;
  double time_unit_s = 1.0;
};

/// By the names that drivers and tools use, upper or lower case, with or without CloudCompare's
/// `scalar_`: x y z (VeloView: Points_m_XYZ:0 to 2, Points:0 to 2), intensity (reflectivity,
/// remission, i), ring (laser_id, channel, line), time (t, time_us, time_ns, offset_time [ns],
/// adjustedtime [us], timestamp, time_stamp); of two names for one thing the first in this list.
/// Other columns (azimuth, distance, normals, colours) are left alone. Error: kParse where x, y or
/// z is missing or a name stands twice; it does not name the file.
Expected<CloudColumns> FindCloudColumns(std::span<const NamedColumn> columns);

}  // namespace sextant
