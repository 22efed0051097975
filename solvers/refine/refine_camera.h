// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "solvers/core/camera_estimate.h"
#include "solvers/refine/refine_ceres.h"

namespace sextant {

/// Kinds of intrinsics that may be estimated along with the pose, as bits of a set.
enum IntrinsicKind : unsigned {
  kFocal = 1U,       ///< fx, fy.
  kCenter = 2U,      ///< cx, cy.
  kDistortion = 4U,  ///< The first coefficients of the model (Brown-Conrady: k1 k2 p1 p2,
                     ///< equidistant: k1 k2) and all others that are not 0 in the given camera.
};

/// Ascending indices into IntrinsicsOf of the intrinsics of these kinds. Error: kInvalidInput for
/// the distortion of a pinhole.
Expected<std::vector<int>> FreeIntrinsics(const Camera& camera, unsigned kinds);

struct RefinedPoseAndCamera {
  Rigid3d cam_from_lidar;
  std::optional<Matrix6d> covariance;  ///< (dphi, dt), marginal over the intrinsics.
  CameraEstimate camera;
  int iterations = 0;
  std::vector<std::string> warnings{};  ///< As of Estimate.
};

/// argmin over SE(3) and the intrinsics `free` of 1/2 sum rho(|r_i|^2), near `start` and the
/// camera of the terms: self-calibration by bundle adjustment of one view (Triggs et al. 2000),
/// by ceres::Problem.
///
/// The covariance is the inverse of sum rho' J^T J over pose and intrinsics, times the factor by
/// which the residuals show that the variance is larger (LossVariance), and times the residual
/// variance where the noise was only assumed; with the shift that outliers make (OutlierPull).
/// Errors: kTooFewPairs (fewer residuals than unknowns), kDegenerate (a singular information, or
/// an intrinsic with a sigma of over a quarter of the focal length or radius that it acts on: with
/// one plane that faces the camera, or all points at one depth, focal length and distance are not
/// separable),
/// kNoConvergence (also where the refined camera would fold the image).
Expected<RefinedPoseAndCamera> RefinePoseAndCamera(const PairTerms& terms, const Rigid3d& start,
                                                   const std::vector<int>& free,
                                                   const RobustLoss& loss,
                                                   const RefineLimits& limits);

}  // namespace sextant
