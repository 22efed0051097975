// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "base/error.h"
#include "geometry/rigid3d.h"
#include "solvers/kernels/cloud_sums.h"
#include "solvers/kernels/p3p.h"
#include "solvers/pnp/image_moments.h"
#include "solvers/pnp/point_cloud_frame.h"

namespace sextant {

/// Which of its candidates an algebraic solver returns.
struct PnpChoice {
  /// The best, even if points are behind the camera or their image is not explained, which is an
  /// error otherwise: for intermediate steps on data that still contains outliers.
  bool unchecked = false;
  /// The candidate nearest to this pose instead of the best, unchecked: to differentiate a solution
  /// by the image points.
  const Rigid3d* near = nullptr;
};

/// Points and their images, checked, with the sums that every algebraic solver starts from.
struct Correspondences {
  std::span<const Eigen::Vector2d> image_points;  ///< (x/z, y/z).
  std::span<const Eigen::Vector3d> points;        ///< In the LiDAR frame [m].
  PointCloudFrame frame;
  ImageMoments moments;
};

/// Errors: kTooFewPairs, and those of FramePointCloud and ComputeImageMoments.
Expected<Correspondences> PrepareCorrespondences(std::span<const Eigen::Vector2d> image_points,
                                                 std::span<const Eigen::Vector3d> points,
                                                 std::size_t min_points);

/// Reprojection errors of a rotation and the centroid in the camera frame.
ImageFit FitOf(const Correspondences& data, const Eigen::Matrix3d& rotation,
               const Eigen::Vector3d& centroid_in_cam);

/// One undamped Gauss-Newton step on x - u z and y - v z. The algebraic solvers work on squares of
/// the data, which costs half the digits of an exact pose where the points are badly spread; this
/// restores them. Does nothing where the residuals are larger than those of exact data.
void PolishIfExact(const Correspondences& data, const ImageFit& fit, Eigen::Matrix3d& rotation,
                   Eigen::Vector3d& centroid_in_cam);

/// The three of the first four different points that span the largest triangle.
std::array<std::size_t, 3> WidestTriangle(const Correspondences& data);

struct TrianglePoses {
  std::array<Rigid3d, kMaxP3pPoses> poses;
  int count = 0;
};

/// P3P on the widest triangle.
TrianglePoses PosesOfWidestTriangle(const Correspondences& data);

/// The ratio of squared errors above which a pose behind the camera, or a mirror image, counts as a
/// better fit: noise exceeds it once in 10^5 trials (ratio of two chi^2 of 2 count - 6 degrees of
/// freedom). Five in RMSE for many points, as in kabsch; infinite for three, which always fit.
double MirrorRatio(std::size_t count);

/// kMirrored; see the errors of SolveEpnp.
tl::unexpected<Error> MirroredError();
/// kNoConsensus; see the errors of SolveEpnp.
tl::unexpected<Error> UnexplainedError();

}  // namespace sextant
