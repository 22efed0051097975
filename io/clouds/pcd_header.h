// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace sextant {

enum class PcdEncoding { kAscii, kBinary, kBinaryCompressed };

/// "ascii", "binary" or "binary_compressed". Error: kUnknownName, with the nearest known.
Expected<PcdEncoding> FindPcdEncoding(std::string_view name);
std::string_view ToString(PcdEncoding encoding);

struct PcdField {
  std::string name{};
  char type = 'F';           ///< F floating point, U unsigned, I signed.
  std::size_t size = 4;      ///< Bytes of one value.
  std::size_t count = 1;     ///< Values a point.
  std::size_t offset = 0;    ///< Bytes before it in a point.
  std::size_t position = 0;  ///< Values before it in a point.
};

/// The header of a PCD file, version 0.6 or 0.7.
struct PcdHeader {
  std::vector<PcdField> fields{};
  std::size_t point_bytes = 0;
  std::size_t point_values = 0;
  std::size_t points = 0;
  PcdEncoding encoding = PcdEncoding::kAscii;
  std::size_t body = 0;  ///< Where the data begins in the file.
  int body_line = 1;     ///< The line it begins on.

  /// The field of that name with one value a point, or null.
  const PcdField* Find(std::string_view name) const;
};

/// Errors: kParse with file and line: no header, lists of different lengths, types and sizes that
/// PCD does not have, a name twice, POINTS that is not WIDTH x HEIGHT.
Expected<PcdHeader> ParsePcdHeader(std::string_view text, const std::string& file);

}  // namespace sextant
