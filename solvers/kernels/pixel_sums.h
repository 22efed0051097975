// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "geometry/calibration_problem.h"
#include "geometry/rigid3d.h"
#include "solvers/kernels/p3p.h"
#include "solvers/kernels/pixel_terms.h"

namespace sextant {

/// A pinhole camera at a pose, in the form that the loops over blocks use.
struct PinholePose {
  PinholePose(const Camera& camera, const Rigid3d& cam_from_lidar);
  PinholePose(const Camera& camera, const P3pPoses& poses, std::size_t candidate,
              std::size_t triple);

  double r[9];  ///< Row by row.
  double t[3];
  double fx, fy, cx, cy;
};

/// The sums over terms that least squares needs, of r and J, its derivative by (dphi, dt) of
/// Perturb.
struct PixelSums {
  Matrix6d information;  ///< J^T J
  Vector6d gradient;     ///< J^T r
  double squares = 0.0;  ///< r^T r
};

/// Sums over all terms, in the same order on every machine. False, with meaningless sums, where a
/// point is not in front of the camera.
bool SumPixels(std::span<const PixelBlock> blocks, const PinholePose& pose, PixelSums& sums);

/// Sums over the terms with r^2 <= max_squared; `squares` is the MSAC cost sum_i min(r_i^2,
/// cost_squared) over all terms. A point behind the camera has an infinite r^2. Returns the number
/// of terms that were summed.
int SumPixelsWithin(PixelTermsView terms, const PinholePose& pose, double max_squared,
                    double cost_squared, PixelSums& sums);

/// Writes r_i^2 of all terms. Shape: `squared` has eight numbers for each block.
void SquarePixels(std::span<const PixelBlock> blocks, const PinholePose& pose, double* squared);

/// The MSAC cost sum_i min(r_i^2, max_squared), or any number >= `give_up` as soon as the sum has
/// reached it.
double TruncatedPixelCost(std::span<const PixelBlock> blocks, const PinholePose& pose,
                          double max_squared, double give_up);

/// Residuals at a pose, over the pairs that project, as Evaluation defines them.
struct PixelErrors {
  int projected = 0;
  double squares_px2 = 0.0;
  double squares = 0.0;  ///< In sigmas, or in pixels where no sigma is stated.
};

/// Returns the sums and writes the distances [px] between pixels and projections, infinite behind
/// the camera. Shape: as many distances as pairs.
PixelErrors MeasurePixels(std::span<const Pair2d3d> pairs, const PinholePose& pose,
                          std::span<double> distances_px);

/// When to reject a pose before all terms are summed: the sequential probability ratio test (Wald
/// 1947; Matas and Chum 2005), one inlier or outlier at a time.
struct PixelScreen {
  /// Rejects nothing.
  PixelScreen() = default;
  /// Keeps poses that have at least half of `inlier_share`.
  explicit PixelScreen(double inlier_share);

  double by_outlier = 0.0;  ///< Log ratio, bad over good, that an outlier adds.
  double by_inlier = 0.0;
  double give_up = 1.0;
};

/// TruncatedPixelCost of terms in random order; infinite where the screen rejects the pose.
double ScreenedPixelCost(std::span<const PixelBlock> blocks, const PinholePose& pose,
                         double max_squared, double give_up, const PixelScreen& screen);

}  // namespace sextant
