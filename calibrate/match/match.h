// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "calibrate/match/matched_board.h"
#include "calibrate/observe/observe.h"
#include "geometry/rigid3d.h"

namespace sextant {

struct MatchSettings {
  /// A rough cam_from_lidar. Only its rotation is looked at, and only where the views leave several
  /// poses; none: AxesCamFromLidar().
  std::optional<Rigid3d> initial{};
  /// What corners of a board are off besides their stated noise, per axis [m]: edges that the
  /// beam's spot widens, bent boards, lens models.
  double floor_m = 0.01;
};

/// A board that is left out because its pose is not that of the other views.
struct DroppedBoard {
  MatchedBoard match{};  ///< The way that comes nearest.
  double off_m = 0.0;    ///< RMS distance of its corners between the sensors.
  double off_rad = 0.0;  ///< Angle between its two orientations.
};

/// What belongs together in all views.
struct Matching {
  Rigid3d cam_from_lidar{};          ///< Which the kept boards' corners gave.
  std::vector<MatchedBoard> kept{};  ///< By view.
  std::vector<DroppedBoard> dropped{};
  /// By how much the next distinct pose explains the views worse: chi-square, in units in which
  /// the corners of this one have their stated noise. None where there is no other.
  std::optional<double> margin{};
  /// Poses that explain the views as well as this one (margin under 9.2: 1 % by a likelihood-ratio
  /// test). This one is nearest to the initial rotation; nothing else speaks for it.
  std::vector<Rigid3d> as_likely{};
};

/// Which patch of each scan is which board of its image, and how it lies there.
///
/// Nothing is taken from ids of boards in scans, from their order or from a corner's place: every
/// placement that an outline allows and every pose that an image leaves is tried against one
/// cam_from_lidar for all views (solvers/matching/object_match.h). What is more than four sigmas
/// off that pose, in root mean square over its corners, is dropped. `view` of the matches is the
/// place within `views`. Errors: kTooFewPairs where no view has a board that both sensors saw;
/// kDegenerate.
Expected<Matching> MatchViews(std::span<const Observation> views,
                              const MatchSettings& settings = {});

/// What has to be said of it: that poses are equally likely and which was taken, a line each; empty
/// where there is nothing.
std::vector<std::string> DescribeAmbiguity(const Matching& matching, const MatchSettings& settings);

}  // namespace sextant
