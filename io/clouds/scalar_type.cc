// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/scalar_type.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace sextant {
namespace {

template <class Number>
double Load(const char* bytes, bool big_endian) {
  std::array<char, sizeof(Number)> raw;
  std::memcpy(raw.data(), bytes, raw.size());
  if (big_endian != (std::endian::native == std::endian::big)) std::reverse(raw.begin(), raw.end());
  return static_cast<double>(std::bit_cast<Number>(raw));
}

}  // namespace

std::size_t SizeOf(ScalarType type) {
  switch (type) {
    case ScalarType::kInt8:
    case ScalarType::kUint8:
      return 1;
    case ScalarType::kInt16:
    case ScalarType::kUint16:
      return 2;
    case ScalarType::kInt32:
    case ScalarType::kUint32:
    case ScalarType::kFloat32:
      return 4;
    case ScalarType::kFloat64:
    case ScalarType::kInt64:
    case ScalarType::kUint64:
      return 8;
  }
  return 0;
}

bool IsInteger(ScalarType type) {
  return type != ScalarType::kFloat32 && type != ScalarType::kFloat64;
}

double LoadScalar(const char* bytes, ScalarType type, bool big_endian) {
  switch (type) {
    case ScalarType::kInt8:
      return Load<std::int8_t>(bytes, big_endian);
    case ScalarType::kUint8:
      return Load<std::uint8_t>(bytes, big_endian);
    case ScalarType::kInt16:
      return Load<std::int16_t>(bytes, big_endian);
    case ScalarType::kUint16:
      return Load<std::uint16_t>(bytes, big_endian);
    case ScalarType::kInt32:
      return Load<std::int32_t>(bytes, big_endian);
    case ScalarType::kUint32:
      return Load<std::uint32_t>(bytes, big_endian);
    case ScalarType::kFloat32:
      return Load<float>(bytes, big_endian);
    case ScalarType::kFloat64:
      return Load<double>(bytes, big_endian);
    case ScalarType::kInt64:
      return Load<std::int64_t>(bytes, big_endian);
    case ScalarType::kUint64:
      return Load<std::uint64_t>(bytes, big_endian);
  }
  return 0.0;
}

float ToFloat(double value) {
  constexpr double kMax = std::numeric_limits<float>::max();
  return std::abs(value) <= kMax ? static_cast<float>(value)
                                 : std::numeric_limits<float>::quiet_NaN();
}

}  // namespace sextant
