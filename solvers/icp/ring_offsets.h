// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solvers/kernels/scans/scan_windows.h"

namespace sextant {

/// Range offset of each row [m] (positive: measured too long), for two scans; empty where they show
/// none.
struct RingOffsets {
  std::vector<double> target_m;
  std::vector<double> source_m;
};

/// Constant range errors of each ring, as spinning LiDARs have besides their noise, from the steps
/// that they cause between the rows of surfaces that are flat along each row.
///
/// Each window of 3 x 3 cells is a plane and three offsets: 1 = m . p - b_row / |p|. With m
/// eliminated, its contribution to the normal equations of the offsets is banded, and the windows
/// of a scan add up. Components that planes nearly absorb (equal for all rows, proportional to the
/// elevation or to its square) are unobservable and not corrected: both scans share them, and they
/// move opposite walls in opposite directions. The offsets have a normal prior with the maximum
/// likelihood sigma, which is 0 where rows scatter no more than returns do.
///
/// Scans of one unit have the same offsets: rows at the same elevation share theirs, unless the
/// scans contradict each other.
RingOffsets EstimateRingOffsets(const ScanWindows& target, const ScanWindows& source);

}  // namespace sextant
