// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/image_noise.h"

#include <Eigen/LU>

namespace sextant {

std::optional<std::vector<Eigen::Matrix2d>> ImageCovariances(
    const Camera& camera, std::span<const Pair2d3d> pairs,
    std::span<const Eigen::Vector2d> image_points, const Eigen::Quaterniond& cam_from_view,
    double unstated_variance) {
  const Eigen::Matrix3d turn = cam_from_view.toRotationMatrix();
  std::vector<Eigen::Matrix2d> covariances;
  covariances.reserve(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto projection = ProjectWithJacobian(camera, turn * image_points[i].homogeneous());
    if (!projection) return std::nullopt;
    const Eigen::Matrix2d pixel_by_image = projection->pixel_by_point * turn.leftCols<2>();
    const Eigen::Matrix2d image_by_pixel = pixel_by_image.inverse();
    if (!image_by_pixel.allFinite()) return std::nullopt;
    const double variance =
        HasKnownNoise(pairs[i]) ? pairs[i].sigma_px * pairs[i].sigma_px : unstated_variance;
    covariances.emplace_back(variance * image_by_pixel * image_by_pixel.transpose());
  }
  return covariances;
}

}  // namespace sextant
