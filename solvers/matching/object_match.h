// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>
#include <span>
#include <vector>

#include "base/error.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// One way in which an object that b saw may be one that a saw: the points that are then the same.
struct ObjectPairing {
  int in_b = 0;                                ///< Which of b's objects of the view...
  int in_a = 0;                                ///< ...would be which of a's.
  std::vector<Eigen::Vector3d> points_in_b{};  ///< At least 3, not on a line [m].
  std::vector<Eigen::Vector3d> points_in_a{};  ///< As many [m].
  double sigma_m = 1.0;                        ///< Of each point's difference, per axis.
  double penalty = 0.0;  ///< Chi-square that something else says against this way.
};

/// What both saw at one moment, in every way in which it may belong together.
struct MatchView {
  std::vector<ObjectPairing> pairings{};
};

struct MatchOptions {
  /// A pairing that costs more is none: the object was moved, or is something else. It then counts
  /// as twice the cap, so that a pose which two objects fit poorly is not given up for one that a
  /// single object fits well. Infinite: every object has a partner.
  double cap = std::numeric_limits<double>::infinity();
  std::vector<Rigid3d> starts{};  ///< b_from_a, tried before those of single pairings.
  std::size_t most_starts = 512;  ///< Of all; of many views, some are taken evenly.
};

/// A pairing that an explanation takes.
struct TakenPairing {
  std::size_t view = 0;
  std::size_t pairing = 0;  ///< Into MatchView::pairings.
  double cost = 0.0;        ///< Sum of |b - T a|^2 / sigma^2, and the penalty.
  bool fits = false;        ///< Below the cap.
};

/// One pose for all views, and what it makes of each.
struct MatchExplanation {
  Rigid3d b_from_a{};
  std::vector<TakenPairing> taken{};  ///< By view; each object at most once.
  double cost = 0.0;  ///< Of all that is taken; twice the cap where it does not fit.
};

/// Which object is which and how it lies, solved over all views at once: one pose must serve all.
///
/// Every single pairing gives a pose (FitKabsch). Under a pose, objects are paired view by view,
/// nearest first, and the pose is fitted again to all pairings below the cap, until nothing moves.
/// Poses that differ enough are all followed, from wide to narrow tolerance.
/// Returns the distinct explanations by ascending cost: neighbours differ by more than 6 degrees or
/// a third of an object. Of those that fit equally well to a micrometre, the earliest start's is
/// first. Errors: kTooFewPairs (no pairing); kDegenerate (no pairing gives a pose).
Expected<std::vector<MatchExplanation>> MatchObjects(std::span<const MatchView> views,
                                                     const MatchOptions& options = {});

/// What the views say of a pose: its pairings and their cost, without fitting it.
MatchExplanation ExplainUnder(std::span<const MatchView> views, const Rigid3d& b_from_a,
                              double cap = std::numeric_limits<double>::infinity());

}  // namespace sextant
