// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <optional>

#include "solvers/pnp/correspondences.h"

namespace sextant {

/// A pose with the centroid in place of the origin, and how well it explains the image.
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

  /// EpnpCandidates are judged by how well they explain the image, or by how near they are to
  /// `near`.
  DepthKernel(const Correspondences& data, const Rigid3d* near);

  const EpnpCandidate& best() const { return best_; }

  void SearchFromKernel();
  void SearchFromWeakPerspective();
  /// The candidates that the answer `near` may have been.
  void SearchNear();
  /// Starts Gauss-Newton at a pose.
  void SearchFrom(const Rigid3d& cam_from_lidar);
  /// The error of the best improper rotation that the first eigenvector gives; infinite where that
  /// is a proper one.
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
  Eigen::Vector2d mean_;  ///< Of the image points.
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
