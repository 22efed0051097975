// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/point_cloud_frame.h"

#include <fmt/core.h>

#include <cmath>

#include "geometry/symmetric.h"
#include "solvers/kernels/cloud_sums.h"

namespace sextant {
namespace {

// Points within 1e-9 of the cloud's size of each other count as one.
constexpr double kSameSquaredDistance = 1e-18;

void FindDifferent(std::span<const Eigen::Vector3d> points, double variance,
                   PointCloudFrame& frame) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    bool is_new = true;
    for (int k = 0; k < frame.different_count && is_new; ++k) {
      const Eigen::Vector3d& other = points[frame.different[static_cast<std::size_t>(k)]];
      is_new = (points[i] - other).squaredNorm() > kSameSquaredDistance * variance;
    }
    if (is_new) frame.different[static_cast<std::size_t>(frame.different_count++)] = i;
    if (frame.different_count == static_cast<int>(frame.different.size())) return;
  }
}

}  // namespace

Expected<PointCloudFrame> FramePointCloud(std::span<const Eigen::Vector3d> points,
                                          int min_different) {
  PointCloudFrame frame;
  frame.centroid = MeanOf(points);
  const Eigen::Matrix3d scatter = ScatterAbout(frame.centroid, points);
  const double variance = scatter.trace();
  if (!(std::sqrt(variance) + frame.centroid.norm() < kMaxDistance_m)) {
    return MakeError(
        ErrorCode::kDegenerate,
        fmt::format("the points are further than {:g} m away, where rounding destroys the "
                    "translation; give LiDAR points in metres",
                    kMaxDistance_m));
  }
  FindDifferent(points, variance, frame);
  if (frame.different_count < min_different) {
    return MakeError(ErrorCode::kDegenerate,
                     fmt::format("only {} of {} points differ from each other, expected at least "
                                 "{}; leave out duplicated pairs and add others",
                                 frame.different_count, points.size(), min_different));
  }
  const SymmetricEigen<3> eigen = EigenOf(scatter);
  const Eigen::Vector3d& ascending = eigen.values;
  if (!(ascending(1) > kMinLineVariance * ascending(2))) {
    return MakeError(ErrorCode::kDegenerate,
                     "the points lie on one line, which leaves the rotation about it undetermined; "
                     "use points that span a plane");
  }
  frame.deviation = ascending.reverse().cwiseMax(0.0).cwiseSqrt();
  frame.axes.col(0) = eigen.vectors.col(2);
  frame.axes.col(1) = eigen.vectors.col(1);
  frame.axes.col(2) = frame.axes.col(0).cross(frame.axes.col(1));
  return frame;
}

}  // namespace sextant
