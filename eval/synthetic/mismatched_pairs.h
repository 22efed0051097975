// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "eval/synthetic/random_scene.h"

namespace sextant {

/// How many of `pairs` stay true where the share `outlier_fraction` does not.
int InlierCount(int pairs, double outlier_fraction);

/// Outliers as a wrong association makes them: pairs beyond the first `inliers` of both kinds get
/// the LiDAR point of another place in the box of the scene that `options` made.
void MismatchPairs(const RandomSceneOptions& options, int inliers, Random& random,
                   RandomScene& scene);

}  // namespace sextant
