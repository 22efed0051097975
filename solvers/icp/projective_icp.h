// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <numbers>
#include <span>

#include "base/error.h"
#include "geometry/rigid3d.h"

namespace sextant {

struct ProjectiveIcpSettings {
  double cell_rad = std::numbers::pi / 90.0;  ///< Height and width of the cells of a scan.
  double max_distance_m = 0.5;                ///< Between a patch and its plane, at the start.
  int max_iterations = 100;
  double rotation_tolerance_rad = 1e-6;
  double translation_tolerance_m = 1e-6;
};

struct ProjectiveIcpFit {
  Rigid3d target_from_source;
  int matches = 0;    ///< Patches of either scan on a plane of the other.
  double rmse = 0.0;  ///< Of their distances, over what noise lets one expect: about 1.
  int iterations = 0;
  bool converged = false;                  ///< Whether the last step was within both tolerances.
  Matrix6d covariance = Matrix6d::Zero();  ///< Of (dphi, dt).
};

/// Aligns two scans of turning LiDARs (or of others, seen from their frame's origin) that differ by
/// some degrees and decimetres.
///
/// Nearest neighbours of rings are on the nearest ring, so that ICP by them stays where rings lie
/// on rings. Here a scan is surfaces (scan_surfaces.h): planes fitted across rings, and middles of
/// cells. Middles are matched to the plane of the cell of the other scan that they are seen in
/// (Blais and Levine 1995), both ways, and Gauss-Newton on the distances to planes (Chen and
/// Medioni 1992) takes a step, until it is within both tolerances. Matches that are far off lose
/// their weight, at first at max_distance_m, then nearer by a factor of 0.6 each iteration down to
/// three standard deviations of the noise. Once there and at rest, matches are kept, so that the
/// steps end.
///
/// Constant errors of the ranges of each ring are taken off first, where the scans show such
/// (ring_offsets.h). The covariance is of the returns' noise and does not hold what is left of
/// them: with 9.5 mm a ring, as measured of one VLP-16, errors are some four times its sigmas.
///
/// Linear in the points: one pass over them; the iterations are over some thousand cells.
/// Deterministic.
///
/// Errors: kTooFewPairs (no points); kDegenerate (too few flat cells in a scan, or they leave a
/// motion free, as a corridor does); kNoConsensus (too few matches: the start is too far off).
Expected<ProjectiveIcpFit> FitProjectiveIcp(std::span<const Eigen::Vector3d> target,
                                            std::span<const Eigen::Vector3d> source,
                                            const Rigid3d& start,
                                            const ProjectiveIcpSettings& settings = {});

}  // namespace sextant
