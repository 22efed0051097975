// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace sextant {

/// The printed pattern of a tag, a square of cells, from the detectors' own libraries.
struct TagPattern {
  int cells = 0;                      ///< Cells along a side of the whole pattern.
  int edge_first = 0;                 ///< First cell of the square whose corners detectors report.
  int edge_cells = 0;                 ///< Cells along a side of that square.
  std::vector<std::uint8_t> white{};  ///< Row by row from the tag's top-left: 1 white, 0 black.

  bool IsWhite(int row, int column) const {
    return white[static_cast<std::size_t>(row * cells + column)] != 0;
  }
};

/// All families: "aruco_original", "aruco_4x4_50" to "aruco_7x7_1000", "tag36h11" and AprilTag's
/// others.
const std::vector<std::string>& TagFamilies();

/// Number of ids of a family; they count from 0. Error: kUnknownName, with a suggestion.
Expected<int> TagCount(std::string_view family);

/// Errors: kUnknownName; kInvalidInput for an id that the family does not have.
Expected<TagPattern> MakeTagPattern(std::string_view family, int id);

/// The number of quarter turns clockwise of `from` relative to `to`, for the squares whose corners
/// detectors report; none if no rotation makes them equal. OpenCV's dictionaries of AprilTag's
/// families begin at another corner than AprilTag does.
std::optional<int> QuarterTurns(const TagPattern& from, const TagPattern& to);

}  // namespace sextant
