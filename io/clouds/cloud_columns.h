// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string>

#include "base/error.h"

namespace sextant {

/// A column of a table of points: a field of PointCloud2, a property of PLY or a CSV column.
struct NamedColumn {
  std::string name;
  bool is_integer = false;  ///< Set for binary formats; integer times are in nanoseconds.
};

/// The columns of a table of points that hold the fields of a PointCloud; kNone if there is none.
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

/// Finds the columns by the names that drivers and tools use, upper or lower case, with or without
/// CloudCompare's prefix `scalar_` and the unit [m] or (m): x y z (VeloView: Points_m_XYZ:0 to 2,
/// Points:0 to 2; point_x), intensity (reflectivity, remission, i), ring (laser_id, channel, line),
/// time (t, time_us, time_ns, offset_time [ns], adjustedtime [us], timestamp, time_stamp). If
/// several columns qualify, the first name in this list is used. Other columns (azimuth, distance,
/// normals, colours) are ignored, and so is the line of a sensor without rings (Livox), which comes
/// with a tag. Error: kParse if x, y or z is missing or a name appears twice; it does not name the
/// file.
Expected<CloudColumns> FindCloudColumns(std::span<const NamedColumn> columns);

/// The columns of a table without names, by their number: x, y and z; the fourth of 4 or 5 is the
/// intensity, the fifth of 5 the ring if every number in it is one. Others are ignored. Requires 3.
CloudColumns UnnamedColumns(std::size_t columns, bool fifth_is_ring);

/// Whether it is a whole number from 0 to 65535.
bool IsRingNumber(double value);

}  // namespace sextant
