// SPDX-License-Identifier: Apache-2.0
#include "solvers/image_moments.h"

#include <array>

namespace sextant {
namespace {

// Rays within 1e-9 rad of each other do not tell a direction.
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
  for (const Eigen::Vector2d& image_point : image_points) moments.mean += image_point;
  moments.mean /= count;
  const Eigen::Matrix3d to_axes = frame.axes.transpose();
  Triangle sum_u{};
  Triangle sum_v{};
  Triangle sum_w{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d h = to_axes * (points[i] - frame.centroid);
    const Eigen::Vector2d uv = image_points[i] - moments.mean;
    const double squares = uv.squaredNorm();
    const Triangle products = {1.0,           h.x(),         h.y(),         h.z(),
                               h.x() * h.x(), h.x() * h.y(), h.x() * h.z(), h.y() * h.y(),
                               h.y() * h.z(), h.z() * h.z()};
    for (std::size_t k = 0; k < products.size(); ++k) {
      sum_u[k] += uv.x() * products[k];
      sum_v[k] += uv.y() * products[k];
      sum_w[k] += squares * products[k];
    }
  }
  moments.u = Mean(sum_u, count);
  moments.v = Mean(sum_v, count);
  moments.w = Mean(sum_w, count);
  if (!(moments.Spread() > kMinSpread)) {
    return MakeError(ErrorCode::kDegenerate,
                     "all pixels coincide: the points are too far away, or their pixels are wrong");
  }
  return moments;
}

}  // namespace sextant
