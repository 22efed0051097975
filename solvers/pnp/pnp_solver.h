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
#include "solvers/pnp/triple_covariance.h"

namespace sextant {

/// What a kernel for 2D-3D pairs works on, whatever the camera model.
struct PnpInput {
  std::span<const Eigen::Vector2d> image_points;  ///< (x/z, y/z).
  std::span<const Eigen::Vector3d> points;        ///< In the LiDAR frame [m].
  double focal_length_px = 1.0;                   ///< Pixels per unit of the image plane.
  PnpChoice choice = {};                          ///< For kernels that have several candidates.
};

struct PnpPoses {
  std::array<Rigid3d, 4> poses;  ///< cam_from_lidar, best first.
  int count = 0;
  std::vector<int> inliers = {};  ///< Ascending; empty for all.
  int iterations = 0;
  std::optional<Triple> fixed_by = {};  ///< Where three pairs fix the poses and others only choose.
};

using PnpKernel = std::function<Expected<PnpPoses>(const PnpInput&)>;

/// What is known of a kernel's answer, which says how its covariance is found.
enum class PnpCovariance {
  kObjectSpace,   ///< A minimum of the squares of x - u z, y - v z: ObjectSpaceCovariance.
  kMoments,       ///< A function of the image's moments: MomentCovariance.
  kTriple,        ///< Exact on PnpPoses::fixed_by: TripleCovariance.
  kLeastSquares,  ///< Minimum of the reprojection error over the inliers: ReprojectionCovariance.
};

/// Any kernel behind the solver interface: pixels become image points by the camera's own model.
/// Where a wide lens sees pixels near or beyond 90 deg from the optical axis, the kernel gets the
/// image points of a camera turned onto the mean ray.
class PnpSolver final : public Solver {
 public:
  PnpSolver(SolverSpec spec, PnpKernel kernel, PnpCovariance covariance);
  /// Of kind kMoments, for a kernel that can be given displaced moments.
  PnpSolver(SolverSpec spec, PnpKernel kernel, MomentsKernel of_moments);

 private:
  Expected<Estimate> DoSolve(const CalibrationProblem& problem) const override;
  void DoHypothesize(const CalibrationProblem& problem, std::span<const int> sample,
                     std::vector<Rigid3d>& poses) const override;
  Error Named(Error error) const;

  PnpKernel kernel_;
  PnpCovariance covariance_;
  MomentsKernel of_moments_ = {};
};

}  // namespace sextant
