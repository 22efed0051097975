// SPDX-License-Identifier: Apache-2.0
#pragma once

// Limits that several steps of finding a board's edges must agree on.
namespace sextant {

/// Between neighbours of a ring within an interval, in steps of its azimuth: one drop-out.
inline constexpr double kMaxGapSteps = 2.5;

/// Of a return to the plane that it counts to: these sigmas, and no less than that distance.
inline constexpr double kPlaneSigmas = 2.5;
inline constexpr double kMinThreshold_m = 0.03;

}  // namespace sextant
