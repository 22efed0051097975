// SPDX-License-Identifier: Apache-2.0
#pragma once

// Limits shared by several steps of the search for a board's edges.
namespace sextant {

/// Maximum gap between neighbours of a ring, in steps of its azimuth: allows one drop-out.
inline constexpr double kMaxGapSteps = 2.5;

/// Maximum distance of a return from its plane, in sigmas, and the lower bound of that distance.
inline constexpr double kPlaneSigmas = 2.5;
inline constexpr double kMinThreshold_m = 0.03;

}  // namespace sextant
