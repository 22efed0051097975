// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "base/units.h"
#include "calibrate/scene/scene_search.h"

namespace sextant {

enum class PoseState { kValid, kMoved, kUnknown };

/// "still valid", "moved" or "cannot tell".
std::string_view ToString(PoseState state);

/// A pose is called valid only where a change of this size would have been seen, and where any
/// change that is certain is smaller.
struct CheckLimits {
  double rotation_rad = 0.0;
  double translation_m = 0.0;
};

/// A judged pose.
struct PoseCheck {
  PoseState state = PoseState::kUnknown;
  bool is_certain = false;  ///< The pose has changed, by however little.
  std::string reason{};     ///< One sentence.
  /// PoseDifference(measured pose, given pose), in the axes of the camera, and its covariance.
  Vector6d change = Vector6d::Zero();
  Matrix6d covariance = Matrix6d::Zero();
};

/// Quantile 98 % of the chi-square distribution of 6: the squared Mahalanobis distance that a pose
/// that has not moved exceeds in 2 percent of the checks.
inline constexpr double kMovedDistance = 15.03;

/// A change is certain if its distance exceeds kMovedDistance. The pose has moved if so, unless the
/// change is smaller than `limits` in every direction (98 %). Else it is valid if a change of
/// `limits` in any direction would have been seen, else unknown. `what` names the `samples`:
/// "different scenes", "views of the board".
PoseCheck JudgeChange(const Vector6d& change, const Matrix6d& covariance, const CheckLimits& limits,
                      int samples, std::string_view what);

/// Why nothing is known by this fit: too few edges, edges that coincide hardly better than by
/// chance, or halves of the scenes that do not confirm each other. Empty if something is.
std::string WhyUnclear(const SceneFit& fit);

/// The largest change that a search measures; beyond it the optimum may be a wrong one.
inline constexpr double kSearchedRotation_rad = 2.0 * kRadPerDeg;
inline constexpr double kSearchedTranslation_m = 0.1;

/// Whether a fit is farther from its start than that.
bool EndedAtLimit(const SceneFit& fit, const Rigid3d& start);

/// The squared Mahalanobis distance of the measured pose from the given one by the spread of its
/// own optimum, reduced where few tiles show that spread.
double DistanceOfChange(const SceneFit& fit, const Rigid3d& given);

/// How the stated intrinsics contradict the scenes, whatever the pose: a phrase. Empty if they do
/// not, or not clearly.
std::string WrongIntrinsics(const SceneFit& fit);

/// The same for a fit that was started at the given pose. The threshold grows where few tiles show
/// the spread. A pose has moved, too, if its own edges coincide far worse than those of the fit,
/// and nothing is known where even those coincide hardly better than by chance, or where wrong
/// intrinsics explain the change. The covariance is that of the fit; infinite where the pose has
/// moved and the search ended at its limit.
PoseCheck CheckScenes(const SceneFit& fit, const Rigid3d& given, const CheckLimits& limits);

}  // namespace sextant
