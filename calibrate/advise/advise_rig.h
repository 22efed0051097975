// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "geometry/uncertain_pose.h"
#include "io/problems/rig_yaml.h"

namespace sextant {

/// Two sensors of a rig, and how well their pose is known.
struct RigPairKnown {
  std::string a{};
  std::string b{};
  UncertainPose a_from_b{};
  int views = 0;  ///< Boards that both see.
};

/// Where to hold a board next for the pair of sensors that is known worst.
struct RigAdvice {
  RigPairKnown weakest{};
  double distance_m = 0.0;             ///< At which pairs are compared: that of the boards so far.
  std::vector<std::string> seen_by{};  ///< The sensors that would see the proposed board.
  Rigid3d root_from_board{};
  Matrix6d covariance{};   ///< What the weakest pair has with that board.
  std::string sentence{};  ///< As one of the sensors that would see it sees it.
  int considered = 0;      ///< Places of the grid that two sensors or more would see.
  std::vector<std::string> warnings{};
};

/// Solves a rig, and proposes one more moment: of a grid of places and tilts about the rig the one
/// that leaves the pair of sensors known worst the smallest covariance (D-optimal). The worst one
/// is that whose poses move a point at the boards' usual distance most. A sensor is taken to see a
/// board within 15 degrees of where it has seen one, up to 1.3 times as far, tilted by up to 60
/// degrees, as well as it has seen those so far on average. Errors: those of SolveRig; kMissingData
/// where a sensor has no pose, with what would connect it; kDegenerate where no place of the grid
/// is seen by two sensors.
Expected<RigAdvice> AdviseRig(const RigFile& rig);

}  // namespace sextant
