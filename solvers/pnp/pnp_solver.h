// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "solvers/core/solver.h"
#include "solvers/pnp/correspondences.h"
#include "solvers/pnp/moment_slopes.h"
#include "solvers/pnp/reprojection_covariance.h"

namespace sextant {

/// Input of a kernel for 2D-3D pairs, independent of the camera model.
struct PnpInput {
  std::span<const Eigen::Vector2d> image_points;  ///< (x/z, y/z).
  std::span<const Eigen::Vector3d> points;        ///< In the LiDAR frame [m].
  double focal_length_px = 1.0;                   ///< Pixels per unit of the image plane.
  PnpChoice choice = {};                          ///< For kernels with several candidates.
};

struct PnpPoses {
  std::array<Rigid3d, 4> poses;  ///< cam_from_lidar, best first.
  int count = 0;
  std::vector<int> inliers = {};  ///< Ascending; empty for all.
  int iterations = 0;
  /// The triple, where three pairs determine the poses and the others only select one.
  std::optional<Triple> fixed_by = {};
};

using PnpKernel = std::function<Expected<PnpPoses>(const PnpInput&)>;

/// What a kernel's solution minimises, which determines the formula of its covariance.
enum class PnpCovariance {
  kObjectSpace,   ///< A minimum of the squares of x - u z, y - v z: ObjectSpaceCovariance.
  kMoments,       ///< A function of the image's moments: MomentCovariance.
  kTriple,        ///< Exact on PnpPoses::fixed_by: TripleCovariance.
  kLeastSquares,  ///< Minimum of the reprojection error over the inliers: ReprojectionCovariance.
};

/// What to do with pixels that span more than 168 deg, which no image plane holds.
enum class WideViews {
  kRefused,       ///< kInvalidInput.
  kLeastSquares,  ///< Least squares of the pixels from the poses of p3p, with a warning.
};

/// Makes a Solver of any kernel: the camera's own model converts pixels to image points. Where
/// pixels of a wide lens are near or beyond 90 deg from the optical axis, the kernel gets the image
/// points of a camera rotated onto the mean ray.
class PnpSolver final : public Solver {
 public:
  PnpSolver(SolverSpec spec, PnpKernel kernel, PnpCovariance covariance,
            WideViews wide_views = WideViews::kRefused);
  /// With covariance kMoments, for a kernel that takes displaced moments; wide views by least
  /// squares.
  PnpSolver(SolverSpec spec, PnpKernel kernel, MomentsKernel of_moments);

 private:
  Expected<Estimate> DoSolve(const CalibrationProblem& problem) const override;
  void DoHypothesize(const CalibrationProblem& problem, std::span<const int> sample,
                     std::vector<Rigid3d>& poses) const override;
  Error Named(Error error) const;

  PnpKernel kernel_;
  PnpCovariance covariance_;
  WideViews wide_views_;
  MomentsKernel of_moments_ = {};
};

}  // namespace sextant
