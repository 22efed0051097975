// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "support/scenes.h"

namespace sextant::test {

/// Replaces the measurements of a random fraction of the pairs by random ones of the same kind:
/// camera points anywhere in the scene's cube, pixels anywhere in the image. Returns the indices of
/// the remaining true pairs, ascending.
std::vector<int> AddOutliers(double share, const SceneOptions& options, Random& random,
                             PairScene& scene);

/// The scene with only the pairs at `indices`.
CalibrationProblem Only(const CalibrationProblem& problem, const std::vector<int>& indices);

}  // namespace sextant::test
