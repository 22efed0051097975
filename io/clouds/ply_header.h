// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "io/clouds/scalar_type.h"

namespace sextant {

enum class PlyEncoding { kAscii, kLittleEndian, kBigEndian };

struct PlyProperty {
  std::string name;
  ScalarType type = ScalarType::kFloat32;  ///< Of the entries, for a list.
  bool is_list = false;
  ScalarType length_type = ScalarType::kUint8;  ///< Of a list's length.
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;  ///< As stated; nothing is yet known of the rows.
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kAscii;
  std::vector<PlyElement> elements;
  std::size_t size = 0;  ///< Bytes, the line end_header included.
  int lines = 0;         ///< As many.
};

/// Error: kParse, with the line. Lines over 1000 bytes and more than 1000 of them are refused.
Expected<PlyHeader> ParsePlyHeader(std::string_view bytes, const std::string& file);

}  // namespace sextant
