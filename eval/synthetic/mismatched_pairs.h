// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "eval/synthetic/random_scene.h"

namespace sextant {

/// Number of inliers among `pairs` for the given fraction of outliers.
int InlierCount(int pairs, double outlier_fraction);

/// Makes outliers as wrong associations do: in both kinds of pairs, all beyond the first `inliers`
/// get the LiDAR point of another random place in the cube of the scene that `options` describes.
void MismatchPairs(const RandomSceneOptions& options, int inliers, Random& random,
                   RandomScene& scene);

}  // namespace sextant
