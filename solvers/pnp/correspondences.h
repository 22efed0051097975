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

/// Which of its candidates an algebraic solver answers with.
struct PnpChoice {
  /// The best, though points are behind the camera or their image is not explained: for steps on
  /// the way to an answer, whose data still holds outliers. Otherwise that is an error.
  bool unchecked = false;
  /// The nearest to this pose in place of the best, unchecked: its answer is followed while the
  /// image is displaced.
  const Rigid3d* near = nullptr;
};

/// Points and their images, checked, with what every algebraic solver for them starts from.
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

/// How a rotation with the centroid in the camera frame explains the image.
ImageFit FitOf(const Correspondences& data, const Eigen::Matrix3d& rotation,
               const Eigen::Vector3d& centroid_in_cam);

/// One Gauss-Newton step on x - u z and y - v z. The algebraic solvers work on squares of the data,
/// which costs an exact pose half its digits where the points are badly spread; this gives them
/// back. Does nothing where the residuals are not those of exact data.
void PolishIfExact(const Correspondences& data, const ImageFit& fit, Eigen::Matrix3d& rotation,
                   Eigen::Vector3d& centroid_in_cam);

/// Of the first four different points, the three that span the largest triangle.
std::array<std::size_t, 3> WidestTriangle(const Correspondences& data);

struct TrianglePoses {
  std::array<Rigid3d, kMaxP3pPoses> poses;
  int count = 0;
};

/// P3P on the widest triangle.
TrianglePoses PosesOfWidestTriangle(const Correspondences& data);

/// How many times better, in squares, an impossible pose must fit before the points count as
/// mirrored: more than noise does once in 10^5 trials (ratio of two chi^2 of 2 count - 6 degrees of
/// freedom). Five in RMSE for many points, as in kabsch; infinite for three, which always fit.
double MirrorRatio(std::size_t count);

/// kMirrored; see the errors of SolveEpnp.
tl::unexpected<Error> MirroredError();
/// kNoConsensus; see the errors of SolveEpnp.
tl::unexpected<Error> UnexplainedError();

}  // namespace sextant
