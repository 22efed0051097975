// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "base/error.h"
#include "geometry/calibration_problem.h"
#include "solvers/pnp/pnp_view.h"

namespace sextant {

/// Whether a sum of squared residuals [px^2] is small against the extent of the pixels: an RMSE
/// below 5 percent of their spread. Data that no pose explains, or only a mirrored one, leaves far
/// more.
bool IsSmallAgainstImage(std::span<const Pair2d3d> pairs, double sum_squares_px2);

/// Whether sqpnp, which finds all minima in front of the camera and behind it, accepts data that
/// the pose of some solver explains badly, so that all solvers refuse what one of them refuses.
/// Without a search where the residuals are small (IsSmallAgainstImage). A pose that leaves half of
/// the pairs, besides the three that any pose fits, within three quarters of the spread of their
/// pixels is one that sqpnp did not find.
/// `view_from_lidar` is the pose in the view. Errors: kMirrored and kNoConsensus, those of
/// SolveSqpnp.
Expected<void> CheckExplained(const PnpView& view, const Rigid3d& view_from_lidar);

/// The same for a pose of the camera; no error where the pixels do not fit one view.
Expected<void> CheckExplained(const Camera& camera, std::span<const Pair2d3d> pairs,
                              const Rigid3d& cam_from_lidar);

}  // namespace sextant
