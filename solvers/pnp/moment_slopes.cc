// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/moment_slopes.h"

#include <algorithm>

namespace sextant {
namespace {

// The truncation error is 1e-10 relative; rounding of the estimate, 1e-13, adds 1e-8.
constexpr double kDisplacement = 1e-5;

// The upper triangle of a symmetric 4x4 matrix, row by row.
constexpr int kEntries = 10;
using ByEntries = Eigen::Matrix<double, 6, kEntries>;
using TriangleEntries = Eigen::Matrix<double, kEntries, 1>;

TriangleEntries UpperTriangle(const Eigen::Matrix4d& m) {
  TriangleEntries entries;
  int at = 0;
  for (int j = 0; j < 4; ++j) {
    for (int k = j; k < 4; ++k) entries(at++) = m(j, k);
  }
  return entries;
}

// Derivatives of the pose by the moments.
struct Slopes {
  Eigen::Matrix<double, 6, 2> mean;
  ByEntries u, v, w;
};

class Differences {
 public:
  Differences(const ImageMoments& moments, const PoseOfMoments& estimate)
      : moments_(moments), estimate_(estimate) {}

  // Derivative by the parameter that `displace(moments, step)` changes; none where the estimator
  // fails.
  template <class Displace>
  std::optional<Vector6d> By(double step, const Displace& displace) const {
    ImageMoments displaced = moments_;
    displace(displaced, step);
    const std::optional<Rigid3d> ahead = estimate_(displaced);
    displaced = moments_;
    displace(displaced, -step);
    const std::optional<Rigid3d> behind = estimate_(displaced);
    if (!ahead || !behind) return std::nullopt;
    return Vector6d(PoseDifference(*ahead, *behind) / (2.0 * step));
  }

 private:
  const ImageMoments& moments_;
  const PoseOfMoments& estimate_;
};

std::optional<Slopes> Differentiate(const Correspondences& data, const PoseOfMoments& estimate) {
  const Differences differences(data.moments, estimate);
  // Magnitudes of the coordinates in h.
  Eigen::Vector4d size;
  size << 1.0, data.frame.deviation.cwiseMax(1e-7 * data.frame.deviation.x());
  const double image_size = std::sqrt(data.moments.Spread());
  Slopes slopes;
  bool found = true;
  const auto take = [&found](auto column, const std::optional<Vector6d>& slope) {
    found = found && slope;
    if (slope) column = *slope;
  };
  for (int axis = 0; axis < 2; ++axis) {
    take(slopes.mean.col(axis), differences.By(kDisplacement, [axis](ImageMoments& m, double step) {
      m.mean(axis) += step;
    }));
  }
  const auto take_entries = [&](ByEntries& by, Eigen::Matrix4d ImageMoments::*of, double scale) {
    int at = 0;
    for (int j = 0; j < 4; ++j) {
      for (int k = j; k < 4; ++k, ++at) {
        const auto displace = [of, j, k](ImageMoments& m, double step) {
          (m.*of)(j, k) += step;
          if (j != k) (m.*of)(k, j) += step;
        };
        take(by.col(at), differences.By(kDisplacement * scale * size(j) * size(k), displace));
      }
    }
  };
  take_entries(slopes.u, &ImageMoments::u, 1.0);
  take_entries(slopes.v, &ImageMoments::v, 1.0);
  take_entries(slopes.w, &ImageMoments::w, 2.0 * image_size);
  if (!found) return std::nullopt;
  return slopes;
}

Eigen::Matrix4d MeanProducts(const PointCloudFrame& frame) {
  const Eigen::Vector3d& deviation = frame.deviation;
  return Eigen::Vector4d(1.0, deviation.x(), deviation.y(), deviation.z()).cwiseAbs2().asDiagonal();
}

Eigen::Vector4d InFrame(const PointCloudFrame& frame, const Eigen::Vector3d& point) {
  Eigen::Vector4d h;
  h << 1.0, frame.axes.transpose() * (point - frame.centroid);
  return h;
}

// One image coordinate at a time, along its derivative of the moments: as the mean moves with image
// point i, d(u h h^T) = (h_i h_i^T - mean h h^T) / n du_i, d(w h h^T) = 2 (u_i h_i h_i^T - u) / n.
std::optional<Matrix6d> CoordinateByCoordinate(const Correspondences& data,
                                               std::span<const Eigen::Matrix2d> image_covariances,
                                               const PoseOfMoments& estimate) {
  const Differences differences(data.moments, estimate);
  const Eigen::Matrix4d mean_products = MeanProducts(data.frame);
  const double share = 1.0 / static_cast<double>(data.points.size());
  Matrix6d covariance = Matrix6d::Zero();
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    const Eigen::Vector4d h = InFrame(data.frame, data.points[i]);
    const Eigen::Vector2d uv = data.image_points[i] - data.moments.mean;
    const Eigen::Matrix4d products = h * h.transpose();
    Eigen::Matrix<double, 6, 2> by_image;
    for (int axis = 0; axis < 2; ++axis) {
      Eigen::Matrix4d ImageMoments::*const of = axis == 0 ? &ImageMoments::u : &ImageMoments::v;
      const Eigen::Matrix4d first = share * (products - mean_products);
      const Eigen::Matrix4d second = 2.0 * share * (uv(axis) * products - data.moments.*of);
      const std::optional<Vector6d> slope =
          differences.By(kDisplacement, [&](ImageMoments& moments, double step) {
            moments.mean(axis) += share * step;
            moments.*of += step * first;
            moments.w += step * second;
          });
      if (!slope) return std::nullopt;
      by_image.col(axis) = *slope;
    }
    covariance.noalias() += by_image * image_covariances[i] * by_image.transpose();
  }
  return Matrix6d(0.5 * (covariance + covariance.transpose()));
}

}  // namespace

std::optional<Matrix6d> ChainedMomentCovariance(const Correspondences& data,
                                                std::span<const Eigen::Matrix2d> image_covariances,
                                                const PoseOfMoments& estimate) {
  // With more points there are fewer moments (30) than image coordinates.
  constexpr std::size_t kFewPoints = 15;
  if (data.points.size() <= kFewPoints) {
    return CoordinateByCoordinate(data, image_covariances, estimate);
  }
  const std::optional<Slopes> slopes = Differentiate(data, estimate);
  if (!slopes) return std::nullopt;
  // The derivatives of CoordinateByCoordinate, point by point.
  const TriangleEntries mean_entries = UpperTriangle(MeanProducts(data.frame));
  const Vector6d constant_u = slopes->mean.col(0) - slopes->u * mean_entries -
                              2.0 * slopes->w * UpperTriangle(data.moments.u);
  const Vector6d constant_v = slopes->mean.col(1) - slopes->v * mean_entries -
                              2.0 * slopes->w * UpperTriangle(data.moments.v);
  Matrix6d covariance = Matrix6d::Zero();
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    const Eigen::Vector4d h = InFrame(data.frame, data.points[i]);
    const Eigen::Vector2d uv = data.image_points[i] - data.moments.mean;
    const TriangleEntries products = UpperTriangle(h * h.transpose());
    const Vector6d by_w = 2.0 * slopes->w * products;
    Eigen::Matrix<double, 6, 2> by_image;
    by_image.col(0) = constant_u + slopes->u * products + uv.x() * by_w;
    by_image.col(1) = constant_v + slopes->v * products + uv.y() * by_w;
    covariance.noalias() += by_image * image_covariances[i] * by_image.transpose();
  }
  const auto count = static_cast<double>(data.points.size());
  return Matrix6d(0.5 / (count * count) * (covariance + covariance.transpose()));
}

}  // namespace sextant
