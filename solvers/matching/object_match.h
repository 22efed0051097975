// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>
#include <span>
#include <vector>

#include "base/error.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// A candidate association of an object seen by b with one seen by a: their corresponding points.
struct ObjectPairing {
  int in_b = 0;                                ///< Index among b's objects of the view.
  int in_a = 0;                                ///< Index among a's.
  std::vector<Eigen::Vector3d> points_in_b{};  ///< At least 3, not on a line [m].
  std::vector<Eigen::Vector3d> points_in_a{};  ///< As many [m].
  double sigma_m = 1.0;                        ///< Each point's difference, per axis.
  double penalty = 0.0;  ///< Additional chi-square from other evidence against this association.
};

/// All candidate associations of one view. Their number bounds the time: callers limit the objects
/// that are paired with each other.
struct MatchView {
  std::vector<ObjectPairing> pairings{};
};

struct MatchOptions {
  /// A pairing of higher cost is rejected, as the object was moved or is a different one. It then
  /// costs twice the cap, so that a pose under which two objects fit poorly is preferred to one
  /// under which a single object fits well. Infinite: every object has a partner.
  double cap = std::numeric_limits<double>::infinity();
  std::vector<Rigid3d> starts{};  ///< b_from_a, tried before those of single pairings.
  std::size_t max_starts = 512;   ///< With many views, an evenly spread subset is used.
};

/// A pairing chosen in an explanation.
struct TakenPairing {
  std::size_t view = 0;
  std::size_t pairing = 0;  ///< Index into MatchView::pairings.
  double cost = 0.0;        ///< Sum of |b - T a|^2 / sigma^2, and the penalty.
  bool fits = false;        ///< Below the cap.
};

/// One pose for all views, with the pairings chosen under it.
struct MatchExplanation {
  Rigid3d b_from_a{};
  std::vector<TakenPairing> taken{};  ///< By view; each object at most once.
  double cost = 0.0;  ///< Sum over all pairings taken, with twice the cap where one does not fit.
};

/// Finds the association of all objects, and one pose for all views.
///
/// Every single pairing gives a pose (FitKabsch). Under a pose, objects are paired view by view,
/// nearest first, and the pose is fitted again to all pairings below the cap, until these do not
/// change. All sufficiently different poses are refined, from wide to narrow tolerance. Returns the
/// distinct explanations by ascending cost: neighbours differ by more than 6 degrees or a third of
/// an object. Of those that fit equally well to a micrometre, the one with the earliest start is
/// first. Starts are ranked by all views, or, above 8192 pairings, by an evenly spread subset of
/// the views, so that the search takes O(views) time and memory: about 1 us per view and pairing of
/// at most `max_starts` starts in 8192 pairings, and of 24 refined ones in all. Errors:
/// kTooFewPairs (no pairing); kDegenerate (no pairing gives a pose).
Expected<std::vector<MatchExplanation>> MatchObjects(std::span<const MatchView> views,
                                                     const MatchOptions& options = {});

/// The pairings under a given pose and their cost, without a fit.
MatchExplanation ExplainUnder(std::span<const MatchView> views, const Rigid3d& b_from_a,
                              double cap = std::numeric_limits<double>::infinity());

}  // namespace sextant
