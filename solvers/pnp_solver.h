// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <span>
#include <vector>

#include "solvers/solver.h"

namespace sextant {

/// What a kernel for 2D-3D pairs works on, whatever the camera model.
struct PnpInput {
  std::span<const Eigen::Vector2d> image_points;  ///< (x/z, y/z).
  std::span<const Eigen::Vector3d> points;        ///< In the LiDAR frame [m].
  double focal_length_px = 1.0;                   ///< Pixels per unit of the image plane.
};

struct PnpPoses {
  std::array<Rigid3d, 4> poses;  ///< cam_from_lidar, best first.
  int count = 0;
  std::vector<int> inliers = {};  ///< Ascending; empty for all.
  int iterations = 0;
};

using PnpKernel = std::function<Expected<PnpPoses>(const PnpInput&)>;

/// How the covariance of a kernel's answer is found.
enum class PnpCovariance {
  kDifferences,   ///< Propagated through the kernel: any estimator that is smooth in the pixels.
  kLeastSquares,  ///< Of the minimum of the reprojection error over the inliers.
};

/// Any kernel behind the solver interface: pixels become image points by the camera's own model.
/// Where a wide lens sees pixels near or beyond 90 deg from the optical axis, the kernel gets the
/// image points of a camera turned onto the mean ray.
class PnpSolver final : public Solver {
 public:
  PnpSolver(SolverSpec spec, PnpKernel kernel, PnpCovariance covariance);

 private:
  Expected<Estimate> DoSolve(const CalibrationProblem& problem) const override;
  void DoHypothesize(const CalibrationProblem& problem, std::span<const int> sample,
                     std::vector<Rigid3d>& poses) const override;

  Expected<PnpPoses> Run(const Camera& camera, std::span<const Pair2d3d> pairs) const;
  std::optional<Matrix6d> Covariance(const Camera& camera, std::span<const Pair2d3d> pairs,
                                     const Estimate& estimate) const;

  PnpKernel kernel_;
  PnpCovariance covariance_;
};

}  // namespace sextant
