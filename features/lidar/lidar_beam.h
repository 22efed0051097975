// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace sextant {

/// The spot that a beam makes, a rectangle that grows with range, and what it does to edges.
///
/// An edge is seen too far out: a spot that lies on the board by less than half is still measured
/// at the board's range where the echo from behind is the weaker one. How far out depends on what
/// is behind and on the receiver, so that it is known only to `growth_sigma`, alike for all edges
/// of a board. Shares are of the spot's width across the edge.
struct LidarBeam {
  double aperture_h_m = 0.0127;  ///< Of the VLP-16, with what follows.
  double aperture_v_m = 0.0095;
  double divergence_h_rad = 0.003;  ///< Full angle.
  double divergence_v_rad = 0.0015;
  double growth = 0.16;        ///< A simulated VLP-16; real ones 0.07 to 0.13 (docs/simulator.md).
  double growth_sigma = 0.03;  ///< Standard deviation of the growth from board to board.
  double edge_sigma = 0.12;    ///< And of each edge point.

  double WidthAt(double range_m) const { return aperture_h_m + divergence_h_rad * range_m; }
  double HeightAt(double range_m) const { return aperture_v_m + divergence_v_rad * range_m; }
};

/// The sensors whose beams are known, by the simulator's names.
const std::vector<std::string>& LidarBeamNames();

/// Spots from data sheets, growth from the simulator's receiver before a wall (docs/lidar.md).
/// Error: kUnknownName, with the nearest known.
Expected<LidarBeam> FindLidarBeam(std::string_view name);

}  // namespace sextant
