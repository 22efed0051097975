// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/error.h"
#include "base/text/printable.h"  // IWYU pragma: export

namespace sextant {

/// A place in a file; every error message of a reader begins with one.
struct Place {
  std::string_view file;
  int line = 0;                ///< Counts from 1; 0 for the file as a whole.
  std::size_t field = 0;       ///< Counts from 1; 0 for the line as a whole.
  std::string_view name = {};  ///< Name of the field, if the format defines one.
};

/// "points.txt:5: field 2 (camx)".
std::string ToString(const Place& place);

/// The value, or its error with "<place>: " before the message.
template <class T>
Expected<T> AtPlace(Expected<T> value, const Place& place) {
  if (!value) value.error().message.insert(0, ToString(place) + ": ");
  return value;
}

/// The whole text as a number, independent of the locale. Errors: kParse; kNonFinite.
Expected<double> ParseFinite(std::string_view text, const Place& place);

/// The whole text as an integer within [low, high]. Error: kParse.
Expected<std::int64_t> ParseInteger(std::string_view text, std::int64_t low, std::int64_t high,
                                    const Place& place);

}  // namespace sextant
