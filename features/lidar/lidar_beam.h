// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace sextant {

/// The spot of a beam, a rectangle that grows with range, and its effect on edges.
///
/// Edges appear too far out: even if less than half of a spot is on the board, the board's range is
/// measured when the echo from behind is weaker. The distance depends on the background and on the
/// receiver, so it is known only to `growth_sigma`, an error common to all edges of a board. Growth
/// and sigmas are fractions of the spot's width across the edge. Defaults: VLP-16.
struct LidarBeam {
  double aperture_h_m = 0.0127;
  double aperture_v_m = 0.0095;
  double divergence_h_rad = 0.003;  ///< Full angle.
  double divergence_v_rad = 0.0015;
  double growth = 0.16;        ///< Simulated VLP-16; real ones 0.07 to 0.13 (docs/simulator.md).
  double growth_sigma = 0.03;  ///< Standard deviation of the growth between boards.
  double edge_sigma = 0.12;    ///< Standard deviation of the growth between edge points.

  double WidthAt(double range_m) const { return aperture_h_m + divergence_h_rad * range_m; }
  double HeightAt(double range_m) const { return aperture_v_m + divergence_v_rad * range_m; }
};

/// The sensors with known beams, by the simulator's names.
const std::vector<std::string>& LidarBeamNames();

/// The beam of a sensor: spots from data sheets, growth from the simulator's receiver in front of a
/// wall (docs/lidar.md). Error: kUnknownName, with a suggestion.
Expected<LidarBeam> FindLidarBeam(std::string_view name);

}  // namespace sextant
