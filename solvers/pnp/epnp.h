// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "base/error.h"
#include "geometry/rigid3d.h"
#include "solvers/pnp/correspondences.h"
#include "solvers/pnp/moment_slopes.h"

namespace sextant {

struct EpnpFit {
  Rigid3d cam_from_lidar;
  /// sum_i |x_i - projection_i|^2 on the plane z = 1; points behind the camera are left out.
  double sum_squares = 0.0;
};

/// The pose that maps points onto their image, by EPnP (Lepetit, Moreno-Noguer, Fua 2009).
///
/// The points are combinations of control points: their centroid c_0 and one step of a standard
/// deviation along each principal axis, p_i = c_0 + sum_k a_ik d_k; a plane has two axes. Each
/// image (u, v) gives two equations x_i - u z_i = y_i - v z_i = 0, linear in the control points in
/// the camera frame. Lepetit takes the kernel of the 12x12 normal matrix. As sum_i a_ij a_ik =
/// n delta_jk here, the x and y coordinates follow from the depths Z of the control points by a
/// division, and what is left is a symmetric 4x4 problem S Z = lambda Z (3x3 for a plane) with the
/// same kernel. Its metric |Z| = 1 is also the one for which pixel noise causes no bias, as the
/// noise multiplies depths only.
/// The combination of the eigenvectors is fixed by the lengths of the d_k and their right angles.
/// Candidates: the first eigenvector scaled; from there, from the linear solution for two
/// eigenvectors, and from both weak-perspective poses, Gauss-Newton over all of them. The one
/// with the smallest reprojection error is the answer. Where the camera sees only four different
/// points the kernel may have dimension four; the poses of three of them then start Gauss-Newton
/// too.
///
/// Shapes: image points (x/z, y/z), and as many points [m], at least 4 different ones.
/// Errors: kTooFewPairs; kDegenerate (fewer than 4 different points, on one line, a single ray,
/// or too far away for a translation); kMirrored (a mirror image fits far better, see
/// MirrorRatio, as when all points are behind the camera); kNoConsensus (no pose in front of the
/// camera fits better than a single image point for all).
Expected<EpnpFit> SolveEpnp(std::span<const Eigen::Vector2d> image_points,
                            std::span<const Eigen::Vector3d> points_in_lidar,
                            const PnpChoice& choice = {});

/// The solution `near` of SolveEpnp as a function of the moments: its candidate, with the depths to
/// first order and the exact pose for these depths. Empty where no candidate is found.
PoseOfMoments EpnpOfMoments(const Correspondences& data, const Rigid3d& near);

}  // namespace sextant
