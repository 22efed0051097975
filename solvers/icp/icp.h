// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "base/error.h"
#include "geometry/rigid3d.h"

namespace sextant {

enum class IcpMetric {
  kPoint,  ///< Distance to the matched point.
  kPlane,  ///< Distance to the plane through the matched point and its neighbours.
};

struct IcpSettings {
  IcpMetric metric = IcpMetric::kPoint;
  double max_distance_m = 0.0;  ///< Matches at or beyond this are dropped; 0 keeps every match.
  double trim = 0.0;            ///< Fraction of worst matches dropped in each iteration.
  int neighbours = 10;          ///< Points that a normal is fitted to, itself included; 3 or more.
  int max_iterations = 100;
  double rotation_tolerance_rad = 1e-6;
  double translation_tolerance_m = 1e-6;
};

struct IcpMatch {
  int source = 0;
  int target = 0;
  double squared_distance_m2 = 0.0;  ///< Between the points, before the last step.
};

struct IcpFit {
  Rigid3d target_from_source;
  std::vector<IcpMatch> matches;  ///< Matches that the pose was fitted to, by ascending source.
  double rmse_m = 0.0;            ///< RMS of the metric's distance over the matches.
  int iterations = 0;
  /// Whether the last step had |dphi| <= rotation_tolerance_rad and |dt| <=
  /// translation_tolerance_m.
  bool converged = false;
  /// Covariance of (dphi, dt) for correct matches; it does not include errors of matching.
  std::optional<Matrix6d> covariance;
};

/// Iterative closest point: matches each source point to the nearest target point, fits the pose to
/// the matches, and repeats until a step is within both tolerances or max_iterations are done.
/// Local: finds the optimum near `start` only. Deterministic; the k-d tree over the target is built
/// once.
///
/// Each iteration lowers sum |p_j(i) - R a_i - t|^2 (metric kPoint, closed form by FitKabsch), or
/// takes a Gauss-Newton step on sum (n_j(i)^T (R a_i + t - p_j(i)))^2 (kPlane).
/// Sources: Besl and McKay 1992; Chen and Medioni 1992 (planes); Chetverikov et al. 2002
/// (trimming).
///
/// Shapes: 3 or more points [m] each, finite; kPlane needs `neighbours` or more target points.
/// Errors: kTooFewPairs; kDegenerate (the matches are on a line, or their planes do not determine
/// a motion); kNoConsensus (under 3 matches, 6 for planes, are closer than max_distance_m, or the
/// matches look mirrored: the start is too far off).
Expected<IcpFit> FitIcp(std::span<const Eigen::Vector3d> target,
                        std::span<const Eigen::Vector3d> source, const Rigid3d& start,
                        const IcpSettings& settings);

/// The translation that maps the mean of the source onto that of the target; no rotation.
/// Requires points in both.
Rigid3d AlignCentroids(std::span<const Eigen::Vector3d> target,
                       std::span<const Eigen::Vector3d> source);

}  // namespace sextant
