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
  double max_distance_m = 0.5;                ///< From a patch to its plane, at the start.
  int max_iterations = 100;
  double rotation_tolerance_rad = 1e-6;
  double translation_tolerance_m = 1e-6;
};

struct ProjectiveIcpFit {
  Rigid3d target_from_source;
  int matches = 0;    ///< Patches of either scan on a plane of the other.
  double rmse = 0.0;  ///< RMS of their distances over the expected noise: about 1.
  int iterations = 0;
  bool converged = false;                  ///< Whether the last step was within both tolerances.
  Matrix6d covariance = Matrix6d::Zero();  ///< (dphi, dt).
};

/// Aligns two scans of spinning LiDARs (or of others, seen from their frame's origin) that differ
/// by a few degrees and decimetres.
///
/// The nearest neighbours of points on a ring are on the nearest ring, so that ICP with nearest
/// points converges where rings coincide. Here a scan is a set of surfaces (scan_surfaces.h):
/// planes fitted across rings, and the centroids of cells. Each centroid is matched to the plane of
/// the cell of the other scan in whose direction it lies (Blais and Levine 1995), in both
/// directions, and Gauss-Newton steps on the distances to planes (Chen and Medioni 1992) follow
/// until one is within both tolerances. Distant matches are down-weighted, from max_distance_m at
/// first, then by a factor of 0.6 nearer in each iteration, down to three standard deviations of
/// the noise. Once there and nearly converged, the matches stay fixed, so that the steps converge.
///
/// Constant range errors of each ring are subtracted first, where the scans show them
/// (ring_offsets.h). The covariance describes the noise of the returns without the remaining ring
/// offsets: with 9.5 mm per ring, as measured for one VLP-16, errors are about four times the
/// stated sigmas.
///
/// Linear in the number of points, with one pass over them; the iterations run over a few thousand
/// cells. Deterministic.
///
/// Errors: kTooFewPairs (no points); kDegenerate (too few flat cells in a scan, or they leave a
/// motion undetermined, as a corridor does); kNoConsensus (too few matches: the start is too far
/// off).
Expected<ProjectiveIcpFit> FitProjectiveIcp(std::span<const Eigen::Vector3d> target,
                                            std::span<const Eigen::Vector3d> source,
                                            const Rigid3d& start,
                                            const ProjectiveIcpSettings& settings = {});

}  // namespace sextant
