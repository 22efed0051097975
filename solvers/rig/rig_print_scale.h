// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solvers/rig/rig_search.h"

namespace sextant {

/// By which share the print that a camera sees seems to be larger than stated.
struct RigPrintScale {
  std::size_t sensor = 0;
  double share = 0.0;
  double sigma = 0.0;  ///< 0.2, the prior's, where the other sensors do not determine it.
};

/// The scales of the prints of every camera, estimated with all else next to an answer: a wrong
/// size of the print, or a wrong focal length, moves all boards along the line of sight, which
/// poses and other errors could otherwise hide. Cameras alone do not determine a common scale. Time
/// and memory as of one minimum; none where that fails.
std::vector<RigPrintScale> PrintScalesNear(const RigModel& model, const RigAnswer& answer,
                                           const RigOptions& options);

}  // namespace sextant
