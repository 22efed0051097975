// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace sextant {

/// A rectangular board hung from a corner. Its corners are numbered clockwise as the camera sees
/// them, from the top: 0 top, 1 right, 2 bottom, 3 left.
struct Board {
  int id = 0;
  double top_right_m = 0.0;     ///< Edge from the top to the right corner, and its opposite.
  double right_bottom_m = 0.0;  ///< Edge from the right to the bottom corner, and its opposite.

  /// Length of the edge from corner i to corner i + 1 (mod 4).
  std::array<double, 4> EdgeLengths() const {
    return {top_right_m, right_bottom_m, top_right_m, right_bottom_m};
  }
};

inline constexpr int kCornersPerBoard = 4;

}  // namespace sextant
