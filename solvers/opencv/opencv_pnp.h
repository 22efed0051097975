// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solvers/pnp/pnp_solver.h"

namespace sextant {

/// The methods of cv::solvePnPGeneric that run on all pairs.
enum class OpenCvPnp { kEpnp, kSqpnp, kIppe, kIterative };

/// Errors: those of PrepareCorrespondences; kDegenerate where OpenCV throws; kNoConsensus where its
/// answer is not finite or has most points behind the camera.
Expected<PnpPoses> SolveOpenCvPnp(const PnpInput& input, OpenCvPnp method);

/// cv::solveP3P on the widest triangle of the first four different points; its solutions are
/// ordered by the reprojection error of all pairs.
Expected<PnpPoses> SolveOpenCvP3p(const PnpInput& input);

struct OpenCvRansacOptions {
  int max_iterations = 1000;
  double threshold_px = 3.0;
  double confidence = 0.999;
};

/// cv::solvePnPRansac around EPnP: samples of five, then EPnP on the inliers.
Expected<PnpPoses> SolveOpenCvRansacEpnp(const PnpInput& input, const OpenCvRansacOptions& options);

/// cv::solvePnPRansac in its USAC form with MAGSAC++ scoring (Barath et al. 2020) and local
/// optimisation.
Expected<PnpPoses> SolveOpenCvMagsac(const PnpInput& input, const OpenCvRansacOptions& options);

}  // namespace sextant
