// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <optional>

#include "solvers/pnp/correspondences.h"

namespace sextant {

/// A pose given by its rotation and the centroid in the camera frame, with its reprojection errors.
struct EpnpCandidate {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  ImageFit fit{.behind = std::numeric_limits<std::size_t>::max()};

  bool IsBetterThan(const EpnpCandidate& other) const {
    return fit.behind != other.fit.behind ? fit.behind < other.fit.behind
                                          : fit.sum_squares < other.fit.sum_squares;
  }
};

/// The kernel and the length equations for kAxes principal axes: 3, or 2 for a plane.
template <int kAxes>
class DepthKernel {
 public:
  static constexpr int kDepths = kAxes + 1;
  /// Depths of the centroid and of each d_k.
  using Depths = Eigen::Matrix<double, kDepths, 1>;

  /// Candidates are ranked by reprojection error, or by distance from `near` where it is given.
  DepthKernel(const Correspondences& data, const Rigid3d* near);

  const EpnpCandidate& best() const { return best_; }

  void SearchFromKernel();
  void SearchFromWeakPerspective();
  /// The candidates from which the solution `near` may have come.
  void SearchNear();
  /// Starts Gauss-Newton at a pose.
  void SearchFrom(const Rigid3d& cam_from_lidar);
  /// The error of the best improper rotation from the first eigenvector; infinite where the nearest
  /// orthogonal matrix is a proper rotation.
  double MirroredSumSquares() const;

 protected:
  using Square = Eigen::Matrix<double, kDepths, kDepths>;
  using Columns = Eigen::Matrix<double, 3, kDepths>;

  void SetMoments(const ImageMoments& moments);
  Depths DepthsOf(const Rigid3d& cam_from_lidar) const;
  Columns InCamera(const Depths& z) const;
  Depths Scaled(const Depths& z) const;
  Depths FromTwoEigenvectors() const;
  Depths Refined(Depths z) const;
  /// The length equations at z: sum of r J over them, and of J J^T.
  void SumLengthEquations(const Depths& z, Depths& gradient, Square& normal) const;
  bool GaussNewtonStep(Depths& z) const;
  std::optional<EpnpCandidate> PoseOf(const Depths& z, bool mirrored) const;
  ImageFit Judge(const EpnpCandidate& candidate) const;
  void Consider(const Depths& z);

  const Correspondences& data_;
  const Rigid3d* near_;
  Eigen::Matrix<double, kAxes, 1> deviation_;
  Eigen::Vector2d mean_;  ///< Mean of the image points.
  // The moments for coordinates in standard deviations.
  Square about_u_;
  Square about_v_;
  // x = x_by_depth_ z and y = y_by_depth_ z, of the centroid and of each d_k.
  Square x_by_depth_;
  Square y_by_depth_;
  Square reduced_;
  Square eigenvectors_;
  Depths eigenvalues_;
  static constexpr std::size_t kMaxStarts = 5 + 2 * kMaxP3pPoses;
  std::array<Depths, kMaxStarts> considered_;
  int considered_count_ = 0;
  EpnpCandidate best_;
};

}  // namespace sextant
