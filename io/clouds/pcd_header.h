// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "io/clouds/scalar_type.h"

namespace sextant {

enum class PcdEncoding { kAscii, kBinary, kBinaryCompressed };

/// "ascii", "binary" or "binary_compressed". Error: kUnknownName, with a suggestion.
Expected<PcdEncoding> FindPcdEncoding(std::string_view name);
std::string_view ToString(PcdEncoding encoding);

struct PcdField {
  std::string name{};
  char type = 'F';           ///< F floating point, U unsigned, I signed.
  std::size_t size = 4;      ///< Bytes of one value.
  std::size_t count = 1;     ///< Values per point.
  std::size_t offset = 0;    ///< Bytes before it in a point.
  std::size_t position = 0;  ///< Values before it in a point.

  ScalarType scalar_type() const;
};

/// The header of a PCD file, version 0.6 or 0.7.
struct PcdHeader {
  std::vector<PcdField> fields{};
  std::size_t point_bytes = 0;
  std::size_t point_values = 0;
  std::size_t points = 0;
  PcdEncoding encoding = PcdEncoding::kAscii;
  std::size_t body = 0;  ///< Byte in the file at which the data begins.
  int body_line = 1;     ///< Line on which the data begins.
};

/// Errors: kParse with file and line: no header, lists of different lengths, types and sizes that
/// PCD does not define, a repeated name, POINTS that is not WIDTH x HEIGHT. Time and memory are
/// linear in the header's size, whatever it states.
Expected<PcdHeader> ParsePcdHeader(std::string_view text, const std::string& file);

}  // namespace sextant
