// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/image_moments.h"

#include <array>

#include "solvers/kernels/cloud_sums.h"

namespace sextant {
namespace {

// Rays within 1e-9 rad of each other count as one.
constexpr double kMinSpread = 1e-18;

// The upper triangle of a symmetric 4x4 matrix, row by row.
using Triangle = std::array<double, 10>;

Eigen::Matrix4d Mean(const Triangle& sum, double count) {
  Eigen::Matrix4d mean;
  std::size_t at = 0;
  for (int j = 0; j < 4; ++j) {
    for (int k = j; k < 4; ++k) mean(j, k) = mean(k, j) = sum[at++] / count;
  }
  return mean;
}

}  // namespace

Expected<ImageMoments> ComputeImageMoments(std::span<const Eigen::Vector2d> image_points,
                                           std::span<const Eigen::Vector3d> points,
                                           const PointCloudFrame& frame) {
  ImageMoments moments;
  const auto count = static_cast<double>(points.size());
  moments.mean = MeanOf(image_points);
  const MomentSums sums =
      SumMoments(image_points, moments.mean, points, frame.centroid, frame.axes);
  moments.u = Mean(sums.u, count);
  moments.v = Mean(sums.v, count);
  moments.w = Mean(sums.w, count);
  if (!(moments.Spread() > kMinSpread)) {
    return MakeError(ErrorCode::kDegenerate,
                     "all pixels coincide: the points are too far away, or their pixels are wrong");
  }
  return moments;
}

}  // namespace sextant
