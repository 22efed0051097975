// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "geometry/calibration_problem.h"
#include "geometry/rigid3d.h"
#include "solvers/kernels/p3p.h"
#include "solvers/kernels/pixel_terms.h"

namespace sextant {

/// A pinhole camera at a pose, as the loops over blocks take it.
struct PinholePose {
  PinholePose(const Camera& camera, const Rigid3d& cam_from_lidar);
  PinholePose(const Camera& camera, const P3pPoses& poses, std::size_t candidate,
              std::size_t triple);

  double r[9];  ///< Row by row.
  double t[3];
  double fx, fy, cx, cy;
};

/// Sums over terms of what least squares needs of r and of J, its derivative by (dphi, dt) of
/// Perturb.
struct PixelSums {
  Matrix6d information;  ///< J^T J
  Vector6d gradient;     ///< J^T r
  double squares = 0.0;  ///< r^T r
};

/// Over all terms, eight at a time and added up in one order on every machine. False, with sums of
/// no meaning, where a point is not in front of the camera.
bool SumPixels(std::span<const PixelBlock> blocks, const PinholePose& pose, PixelSums& sums);

/// Over the terms with r^2 <= max_squared; `squares` is the MSAC cost sum_i min(r_i^2,
/// cost_squared) over all. A point behind the camera has an infinite r^2. Returns how many terms
/// were summed.
int SumPixelsWithin(PixelTermsView terms, const PinholePose& pose, double max_squared,
                    double cost_squared, PixelSums& sums);

/// r_i^2 of all terms, to places that are as many as those of the blocks.
void SquarePixels(std::span<const PixelBlock> blocks, const PinholePose& pose, double* squared);

/// The MSAC cost sum_i min(r_i^2, max_squared), or any number >= `give_up` as soon as the sum has
/// reached it.
double TruncatedPixelCost(std::span<const PixelBlock> blocks, const PinholePose& pose,
                          double max_squared, double give_up);

/// How pairs are explained, as Evaluation counts it: those that project.
struct PixelErrors {
  int projected = 0;
  double squares_px2 = 0.0;
  double squares = 0.0;  ///< In sigmas, or in pixels where none is stated.
};

/// Sums, and the distances in pixels from the projections, infinite behind the camera. Shape:
/// distances_px has the size of pairs.
PixelErrors MeasurePixels(std::span<const Pair2d3d> pairs, const PinholePose& pose,
                          std::span<double> distances_px);

/// When to give a pose up before all terms were seen: the sequential probability ratio test (Wald
/// 1947; Matas and Chum 2005), an inlier or an outlier at a time.
struct PixelScreen {
  /// Gives up nothing.
  PixelScreen() = default;
  /// Against poses that have half of `inlier_share` at the least.
  explicit PixelScreen(double inlier_share);

  double by_outlier = 0.0;  ///< Log ratio, bad over good, that an outlier adds.
  double by_inlier = 0.0;
  double give_up = 1.0;
};

/// TruncatedPixelCost of terms in random order, infinite where the screen gives the pose up.
double ScreenedPixelCost(std::span<const PixelBlock> blocks, const PinholePose& pose,
                         double max_squared, double give_up, const PixelScreen& screen);

}  // namespace sextant
