// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace sextant {

/// Types of numbers in binary point files. The values are those of sensor_msgs/PointField.
enum class ScalarType : std::uint8_t {
  kInt8 = 1,
  kUint8 = 2,
  kInt16 = 3,
  kUint16 = 4,
  kInt32 = 5,
  kUint32 = 6,
  kFloat32 = 7,
  kFloat64 = 8,
};

/// Bytes that one number takes.
std::size_t SizeOf(ScalarType type);

bool IsInteger(ScalarType type);

/// The number that begins at `bytes`, aligned or not. Requires SizeOf(type) bytes.
double LoadScalar(const char* bytes, ScalarType type, bool big_endian);

}  // namespace sextant
