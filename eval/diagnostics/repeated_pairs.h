// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "geometry/calibration_problem.h"

namespace sextant {

/// A pair with the LiDAR point of an earlier one. Indices into the pairs of the kind.
struct RepeatedPair {
  int first = 0;
  int repeat = 0;
  double apart = 0.0;  ///< Between the two camera observations [m or px].
};

/// Pairs that occur more than once.
struct RepeatedPairs {
  bool in_pixels = false;
  std::vector<RepeatedPair> merged;         ///< They agree, so that they count once.
  std::vector<RepeatedPair> contradictory;  ///< They cannot both be right; both remain.
  int measured = 0;  ///< Pairs in the file, if a scene at rest was measured several times; else 0.
  int points = 0;    ///< Points that they measure.
};

/// Finds the pairs with the LiDAR point of another pair, to 5e-4 of the extent of the points
/// (copies may have been rounded or transformed), and replaces those that agree by one pair with
/// the mean of their camera observations, because one measurement listed several times would
/// otherwise lower the covariance. Where a scene at rest was measured several times, whatever the
/// noise (see PointsOfNearCopies), each point counts once, by its means in both sensors. Two
/// observations contradict each other if they differ by more than a fiftieth of the RMS distance of
/// all observations from their mean and, where the noise is stated, by more than 5 sigmas of their
/// difference. `point_sets` are those of the remaining pairs. O(n log n). Returns what was found in
/// the 3D-3D and in the 2D-3D pairs, if anything.
std::vector<RepeatedPairs> MergeRepeatedPairs(CalibrationProblem& problem);

/// One line each, with pairs counted from 1. Pairs that are no farther apart than the noise of a
/// coordinate `sigma` [m or px] explains do not contradict each other; 0 if it is unknown.
std::vector<std::string> Describe(const RepeatedPairs& repeated, double sigma = 0.0);

/// The place in the file, from 1 on, of the pair at `index` of those that are left after the merge.
int PlaceInFile(int index, bool in_pixels, std::span<const RepeatedPairs> repeated);

}  // namespace sextant
