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
  ScalarType type = ScalarType::kFloat32;  ///< For a list, the type of its entries.
  bool is_list = false;
  ScalarType length_type = ScalarType::kUint8;  ///< Type of a list's length.
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;  ///< As stated in the header, not yet checked against the data.
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kAscii;
  std::vector<PlyElement> elements;
  std::size_t size = 0;  ///< Size of the header in bytes, including the line end_header.
  int lines = 0;         ///< Lines of the header, including end_header.
};

/// Error: kParse, with the line. Lines longer than 1000 bytes and headers of more than 1000 lines
/// are refused. Time and memory are linear in the header's size, whatever it states.
Expected<PlyHeader> ParsePlyHeader(std::string_view bytes, const std::string& file);

}  // namespace sextant
