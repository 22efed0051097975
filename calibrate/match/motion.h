// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "calibrate/match/assemble.h"
#include "geometry/camera.h"

namespace sextant {

struct MotionOptions {
  double max_gap_s = 1.0;      ///< Views further apart in time are not compared.
  double still_m_s = 0.05;     ///< Slower counts as still: 5 mm during a scan of 0.1 s.
  double same_place_m = 0.01;  ///< A board that moved less is in the same place.
  int max_per_place = 5;       ///< More views of one place repeat its systematic errors.
};

/// How far a board moved between two images, perpendicular to the rays: RMS displacement of its
/// printed points at the board's range [m]. None where no print is seen in both.
std::optional<double> MovedBetween(const CameraSighting& a, const CameraSighting& b,
                                   const Camera& camera);

/// Excludes (CameraSighting::left_out) boards that move relative to both the previous and the next
/// image, of those within max_gap_s. Of consecutive views with the board in one place, it keeps
/// max_per_place evenly spread ones. `times_s`: ascending, one per view.
void LeaveOutMotion(std::vector<SessionView>& views, std::span<const double> times_s,
                    const Camera& camera, const MotionOptions& options = {});

}  // namespace sextant
