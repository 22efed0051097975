// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "calibrate/match/assemble.h"
#include "geometry/camera.h"

namespace sextant {

struct MotionOptions {
  double longest_gap_s = 1.0;  ///< Views further apart say nothing of motion.
  double still_m_s = 0.05;     ///< A scan takes a tenth of a second: this is 5 mm in it.
  double same_place_m = 0.01;  ///< A board that moved less hangs where it hung.
  int most_per_place = 5;      ///< Views of one place repeat its systematic errors.
};

/// How far a board moved from one image to another, across the rays: the RMS of what its printed
/// points moved by, at the board's range [m]. None where no print is seen in both.
std::optional<double> MovedBetween(const CameraSighting& a, const CameraSighting& b,
                                   const Camera& camera);

/// Leaves out boards (CameraSighting::left_out) that move against the image before and the image
/// after, of those within the longest gap, and of boards that hang where they hung all but the
/// first few and evenly spread ones. `times_s`: ascending, one a view.
void LeaveOutMotion(std::vector<SessionView>& views, std::span<const double> times_s,
                    const Camera& camera, const MotionOptions& options = {});

}  // namespace sextant
