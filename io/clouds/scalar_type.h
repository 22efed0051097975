// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace sextant {

/// Types of numbers in binary point files. The values up to 8 are those of sensor_msgs/PointField;
/// PCD has 8-byte integers too.
enum class ScalarType : std::uint8_t {
  kInt8 = 1,
  kUint8 = 2,
  kInt16 = 3,
  kUint16 = 4,
  kInt32 = 5,
  kUint32 = 6,
  kFloat32 = 7,
  kFloat64 = 8,
  kInt64 = 9,
  kUint64 = 10,
};

/// Size of one number in bytes.
std::size_t SizeOf(ScalarType type);

bool IsInteger(ScalarType type);

/// The number that begins at `bytes`, aligned or not. Requires SizeOf(type) bytes.
double LoadScalar(const char* bytes, ScalarType type, bool big_endian);

/// The nearest float; NaN for a number outside the range of float.
float ToFloat(double value);

}  // namespace sextant
