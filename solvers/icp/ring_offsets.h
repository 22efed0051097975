// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solvers/kernels/scans/scan_windows.h"

namespace sextant {

/// By how much each row of a scan is measured too long [m], for two scans; empty where they show no
/// such offsets.
struct RingOffsets {
  std::vector<double> target_m;
  std::vector<double> source_m;
};

/// Constant errors of the ranges of each ring, as turning LiDARs have beside their noise, from the
/// steps that they leave between the rows of surfaces that are flat along each row.
///
/// Each window of 3 x 3 cells is a plane and three offsets: 1 = m . p - b_row / |p|. With m
/// eliminated its share in the normal equations of the offsets is banded, and the windows of a scan
/// add up. What planes can nearly take up (all rows alike, rows in proportion to their elevation or
/// to its square) is not told by them and left as it is: both scans have it alike, and it moves
/// opposite walls in opposite directions. The offsets are normal with a sigma that is the likeliest
/// one, which is 0 where rows scatter no more than returns do.
///
/// Scans of one unit have the same offsets: rows at the same elevation share theirs, unless the
/// scans contradict each other.
RingOffsets EstimateRingOffsets(const ScanWindows& target, const ScanWindows& source);

}  // namespace sextant
