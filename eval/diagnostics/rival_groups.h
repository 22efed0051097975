// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eval/diagnostics/repeated_pairs.h"
#include "geometry/calibration_problem.h"
#include "solvers/core/registry.h"

namespace sextant {

/// Pairs that agree on a pose, which is least squares on them.
struct PairGroup {
  Rigid3d cam_from_lidar;
  std::vector<int> members;  ///< Indices of the pairs, ascending.
  double rmse = 0.0;         ///< Over the members [m or px].
};

/// Two groups of about the same size, each of which contradicts the pose of the other. Least
/// squares on all pairs then is a compromise that neither supports, and a robust solver keeps one
/// of them: the data does not determine which is right.
struct RivalGroups {
  bool in_pixels = false;
  std::size_t pairs = 0;  ///< All of this kind, in either group or none.
  std::array<PairGroup, 2> groups;
};

/// The groups of the 3D-3D pairs, or where there are none of the 2D-3D pairs: ransac(kabsch) or
/// ransac(p3p) of `registry` leaves pairs out of which another pose is a rival (FindRivals), with
/// the noise that these pairs show, whatever they state: a sigma that is too small contradicts any
/// pose. Needs four 3D-3D or five 2D-3D pairs in each group; searches in up to 400, evenly spread
/// over the list. Time O(n) beyond these.
std::optional<RivalGroups> FindRivalGroups(const SolverRegistry& registry,
                                           const CalibrationProblem& problem);

/// One sentence, with the pairs by their place in the file, from which `repeated` pairs have been
/// removed.
std::string Describe(const RivalGroups& rivals, std::span<const RepeatedPairs> repeated);

}  // namespace sextant
