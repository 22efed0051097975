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
  /// A rough cam_from_lidar. Its rotation is used only to choose where the views allow several
  /// poses, its translation only where the sensors are far apart. None: AxesCamFromLidar().
  std::optional<Rigid3d> initial{};
  /// Error of a board's corners besides their stated noise, 1 sigma per axis [m]: edges widened by
  /// the beam's spot, bent boards, errors of the lens model.
  double floor_m = 0.01;
  /// The sensors are at most this much further apart than in `initial` [m]: a patch of a scan that
  /// would place them further apart is not the board of the image.
  double max_apart_m = 2.0;
};

/// The largest distance between the sensors that the settings allow [m].
double MaxApart(const MatchSettings& settings);

/// A board that is dropped because its pose contradicts the other views.
struct DroppedBoard {
  MatchedBoard match{};  ///< The association that fits best.
  double off_m = 0.0;    ///< RMS distance of its corners between the sensors.
  double off_rad = 0.0;  ///< Angle between its two orientations.
};

/// Which board is which in all views, under one pose.
struct Matching {
  Rigid3d cam_from_lidar{};          ///< From the corners of the kept boards.
  std::vector<MatchedBoard> kept{};  ///< In the order of the views.
  std::vector<DroppedBoard> dropped{};
  /// How much worse the next distinct pose explains the views: difference in chi-square, in units
  /// in which the corners have their stated noise under this pose. None where there is no other.
  std::optional<double> margin{};
  /// Other poses that explain the views as well (margin under 9.2: 1 % by a likelihood-ratio test).
  /// cam_from_lidar was chosen among them only because it is nearest to the initial rotation.
  std::vector<Rigid3d> alternatives{};
  /// Views with so many patches that only the kMaxPatchesPerBoard best ones for each board were
  /// examined.
  std::vector<int> limited{};
};

inline constexpr std::size_t kMaxPatchesPerBoard = 16;

/// Associates the patches of each scan with the boards of its image, and their corners.
///
/// No identity is assumed in scans, neither by order nor by position: every placement that an
/// outline allows and every pose that an image leaves ambiguous, as far as both sensors' ranges and
/// directions agree (sensor_agreement.h), is tested against one cam_from_lidar for all views
/// (solvers/matching/object_match.h). A board that is more than four sigmas off that pose, in root
/// mean square over its corners, is dropped. MatchedBoard::view is the index into `views`. In a
/// view with more than kMaxPatchesPerBoard patches, each board is only matched with that many whose
/// outlines fit it best, so that time and memory grow with the number of boards and not with its
/// product with that of patches. Errors: kTooFewPairs where no view has a board that both sensors
/// saw; kDegenerate.
Expected<Matching> MatchViews(std::span<const Observation> views,
                              const MatchSettings& settings = {});

/// Warnings about poses that are equally likely, and how one of them was chosen, and about views
/// whose patches were not all examined; empty where the pose is unique.
std::vector<std::string> DescribeAmbiguity(const Matching& matching, const MatchSettings& settings);

}  // namespace sextant
