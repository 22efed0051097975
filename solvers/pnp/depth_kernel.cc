// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/depth_kernel.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "base/simd.h"
#include "geometry/symmetric.h"
#include "solvers/kernels/max_trace_rotation.h"

namespace sextant {

template <int kAxes>
DepthKernel<kAxes>::DepthKernel(const Correspondences& data, const Rigid3d* near)
    : data_(data), near_(near), deviation_(data.frame.deviation.head<kAxes>()) {
  SetMoments(data.moments);
  const SymmetricEigen<kDepths> eigen = EigenOf(reduced_);
  eigenvectors_ = eigen.vectors;
  eigenvalues_ = eigen.values;
}

template <int kAxes>
void DepthKernel<kAxes>::SetMoments(const ImageMoments& moments) {
  mean_ = moments.mean;
  Depths whiten;
  whiten << 1.0, deviation_.cwiseInverse();
  const auto whitened = [&whiten](const Eigen::Matrix4d& moment) -> Square {
    return whiten.asDiagonal() * moment.topLeftCorner<kDepths, kDepths>() * whiten.asDiagonal();
  };
  about_u_ = whitened(moments.u);
  about_v_ = whitened(moments.v);
  x_by_depth_ = about_u_ + mean_.x() * Square::Identity();
  y_by_depth_ = about_v_ + mean_.y() * Square::Identity();
  reduced_ = whitened(moments.w) - about_u_ * about_u_ - about_v_ * about_v_;
}

template <int kAxes>
auto DepthKernel<kAxes>::InCamera(const Depths& z) const -> Columns {
  Columns columns;
  columns.row(0) = (x_by_depth_ * z).transpose();
  columns.row(1) = (y_by_depth_ * z).transpose();
  columns.row(2) = z.transpose();
  return columns;
}

/// The multiple of z that fits |d_k| = deviation_k best, in front of the camera.
template <int kAxes>
auto DepthKernel<kAxes>::Scaled(const Depths& z) const -> Depths {
  const Columns columns = InCamera(z);
  double wanted = 0.0;
  double found = 0.0;
  for (int k = 0; k < kAxes; ++k) {
    const double square = columns.col(k + 1).squaredNorm();
    wanted += square * deviation_(k) * deviation_(k);
    found += square * square;
  }
  return z * std::copysign(std::sqrt(wanted / found), z(0));
}

/// Least squares for beta_1^2, beta_1 beta_2 and beta_2^2, taken as independent.
template <int kAxes>
auto DepthKernel<kAxes>::FromTwoEigenvectors() const -> Depths {
  const Columns first = InCamera(eigenvectors_.col(0));
  const Columns second = InCamera(eigenvectors_.col(1));
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (int j = 1; j < kDepths; ++j) {
    for (int k = j; k < kDepths; ++k) {
      const Eigen::Vector3d row(first.col(j).dot(first.col(k)),
                                first.col(j).dot(second.col(k)) + first.col(k).dot(second.col(j)),
                                second.col(j).dot(second.col(k)));
      normal += row * row.transpose();
      if (j == k) right += row * (deviation_(j - 1) * deviation_(j - 1));
    }
  }
  const Eigen::Vector3d products = normal.inverse() * right;
  Eigen::Vector2d beta;
  if (std::abs(products(0)) > std::abs(products(2))) {
    beta(0) = std::sqrt(std::abs(products(0)));
    beta(1) = products(1) / beta(0);
  } else {
    beta(1) = std::sqrt(std::abs(products(2)));
    beta(0) = products(1) / beta(1);
  }
  const Depths z = eigenvectors_.template leftCols<2>() * beta;
  return z(0) < 0.0 ? Depths(-z) : z;
}

template <int kAxes>
SEXTANT_INLINE void DepthKernel<kAxes>::SumLengthEquations(const Depths& z, Depths& gradient,
                                                           Square& normal) const {
  const Depths x = x_by_depth_ * z;
  const Depths y = y_by_depth_ * z;
  normal.setZero();
  gradient.setZero();
  for (int j = 1; j < kDepths; ++j) {
    for (int k = j; k < kDepths; ++k) {
      const double wanted = j == k ? deviation_(j - 1) * deviation_(j - 1) : 0.0;
      const double residual = x(j) * x(k) + y(j) * y(k) + z(j) * z(k) - wanted;
      Depths row = x(k) * x_by_depth_.col(j) + x(j) * x_by_depth_.col(k) +
                   y(k) * y_by_depth_.col(j) + y(j) * y_by_depth_.col(k);
      row(j) += z(k);
      row(k) += z(j);
      normal.noalias() += row * row.transpose();
      gradient += residual * row;
    }
  }
}

/// One undamped step on d_j . d_k = delta_jk deviation_j^2, whose starts are near the solution;
/// true where another one is worthwhile.
template <int kAxes>
bool DepthKernel<kAxes>::GaussNewtonStep(Depths& z) const {
  Square normal;
  Depths right;
  SumLengthEquations(z, right, normal);
  normal.diagonal() *= 1.0 + 1e-12;
  const Eigen::LLT<Square> factor(normal);
  if (factor.info() != Eigen::Success) return false;
  const Depths step = factor.solve(right);
  z -= step;
  // The angle by which the step rotates the axes.
  constexpr double kSmallStep_rad = 1e-6;
  return step.template tail<kAxes>().squaredNorm() >
         kSmallStep_rad * kSmallStep_rad * deviation_.squaredNorm();
}

template <int kAxes>
auto DepthKernel<kAxes>::Refined(Depths z) const -> Depths {
  constexpr int kMaxSteps = 10;
  for (int i = 0; i < kMaxSteps && GaussNewtonStep(z); ++i) {
  }
  return z;
}

/// The nearest rotation (or, mirrored, the nearest improper one) to the d_k, and the centroid.
template <int kAxes>
std::optional<EpnpCandidate> DepthKernel<kAxes>::PoseOf(const Depths& z, bool mirrored) const {
  const Columns columns = InCamera(z);
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
  cross.topRows<kAxes>() =
      deviation_.asDiagonal() * columns.template rightCols<kAxes>().transpose();
  if (mirrored) cross = -cross;
  const std::optional<MaxTraceRotation> nearest =
      MaximizeTrace(cross, std::sqrt(3.0) * cross.norm());
  if (!nearest) return std::nullopt;
  const double sign = mirrored ? -1.0 : 1.0;
  const Eigen::Matrix3d turned = sign * nearest->rotation.toRotationMatrix();

  EpnpCandidate candidate;
  candidate.rotation = turned * data_.frame.axes.transpose();
  const Eigen::Matrix<double, 3, kAxes> d = turned.leftCols<kAxes>() * deviation_.asDiagonal();
  // Image points and the rotated cloud, both about their means: u z = x. Multiplied by x (not by
  // the noisy u, which would bias the depth towards the camera) and summed, this gives the depth.
  const Eigen::Matrix<double, 1, kAxes> dx = d.row(0) - mean_.x() * d.row(2);
  const Eigen::Matrix<double, 1, kAxes> dy = d.row(1) - mean_.y() * d.row(2);
  const Eigen::Matrix<double, 1, kDepths> slope =
      dx * about_u_.template bottomRows<kAxes>() + dy * about_v_.template bottomRows<kAxes>();
  const double depth =
      (dx.squaredNorm() + dy.squaredNorm() - slope.template tail<kAxes>().dot(d.row(2))) / slope(0);
  const double x = about_u_.row(0).template tail<kAxes>().dot(d.row(2));
  const double y = about_v_.row(0).template tail<kAxes>().dot(d.row(2));
  candidate.centroid << x + mean_.x() * depth, y + mean_.y() * depth, depth;
  candidate.fit = Judge(candidate);
  return candidate;
}

template <int kAxes>
ImageFit DepthKernel<kAxes>::Judge(const EpnpCandidate& candidate) const {
  if (near_ == nullptr) return FitOf(data_, candidate.rotation, candidate.centroid);
  const Eigen::Vector3d centroid = *near_ * data_.frame.centroid;
  return {.behind = 0,
          .sum_squares = (candidate.rotation - near_->rotation.toRotationMatrix()).squaredNorm() +
                         (candidate.centroid - centroid).squaredNorm() / centroid.squaredNorm()};
}

template <int kAxes>
void DepthKernel<kAxes>::Consider(const Depths& z) {
  // Most starts converge to the same depths.
  constexpr double kSameDepths = 1e-10;
  for (int i = 0; i < considered_count_; ++i) {
    const Depths& other = considered_[static_cast<std::size_t>(i)];
    if ((z - other).squaredNorm() < kSameDepths * deviation_.squaredNorm()) return;
  }
  if (!z.allFinite()) return;
  considered_[static_cast<std::size_t>(considered_count_++)] = z;
  const std::optional<EpnpCandidate> candidate = PoseOf(z, /*mirrored=*/false);
  if (candidate && candidate->IsBetterThan(best_)) best_ = *candidate;
}

template <int kAxes>
void DepthKernel<kAxes>::SearchFromKernel() {
  const Depths scaled = Scaled(eigenvectors_.col(0));
  Consider(scaled);
  Consider(Refined(scaled));
  Consider(Refined(FromTwoEigenvectors()));
}

/// With all points at the depth of the centroid, the equations give the first two rows of the
/// rotation and that depth; the third row follows up to the sign of its depths.
template <int kAxes>
void DepthKernel<kAxes>::SearchFromWeakPerspective() {
  Eigen::Matrix<double, 2, kAxes> rows;
  rows.row(0) = about_u_.template block<1, kAxes>(0, 1);
  rows.row(1) = about_v_.template block<1, kAxes>(0, 1);
  rows *= deviation_.cwiseInverse().asDiagonal();
  const Eigen::Matrix2d squares = rows * rows.transpose();
  const double half_gap = 0.5 * (squares(0, 0) - squares(1, 1));
  const double largest = 0.5 * squares.trace() + std::hypot(half_gap, squares(0, 1));
  Depths z;
  z(0) = 1.0 / std::sqrt(largest);
  rows *= z(0);
  if constexpr (kAxes == 3) {
    z.template tail<3>() = rows.row(0).cross(rows.row(1)).transpose();
  } else {
    z(1) = std::sqrt(std::max(0.0, 1.0 - rows.col(0).squaredNorm()));
    z(2) = std::sqrt(std::max(0.0, 1.0 - rows.col(1).squaredNorm()));
    if (rows.col(0).dot(rows.col(1)) > 0.0) z(2) = -z(2);
  }
  z.template tail<kAxes>().array() *= deviation_.array();
  Consider(Refined(z));
  z.template tail<kAxes>() *= -1.0;
  Consider(Refined(z));
}

template <int kAxes>
auto DepthKernel<kAxes>::DepthsOf(const Rigid3d& cam_from_lidar) const -> Depths {
  Depths z;
  z(0) = (cam_from_lidar * data_.frame.centroid).z();
  const Eigen::Matrix3d turned = cam_from_lidar.rotation.toRotationMatrix() * data_.frame.axes;
  z.template tail<kAxes>() =
      (turned.row(2).template head<kAxes>().transpose().array() * deviation_.array()).matrix();
  return z;
}

template <int kAxes>
void DepthKernel<kAxes>::SearchNear() {
  Consider(Scaled(eigenvectors_.col(0)));
  Consider(Refined(DepthsOf(*near_)));
}

template <int kAxes>
void DepthKernel<kAxes>::SearchFrom(const Rigid3d& cam_from_lidar) {
  const Depths z = DepthsOf(cam_from_lidar);
  Consider(z);
  Consider(Refined(z));
}

template <int kAxes>
double DepthKernel<kAxes>::MirroredSumSquares() const {
  const Depths z = Scaled(eigenvectors_.col(0));
  const Columns d = InCamera(z);
  if (kAxes == 2 || !z.allFinite() || d.col(1).cross(d.col(2)).dot(d.col(kAxes)) >= 0.0) {
    return std::numeric_limits<double>::infinity();
  }
  const std::optional<EpnpCandidate> mirrored = PoseOf(z, /*mirrored=*/true);
  if (!mirrored || mirrored->fit.behind > 0) return std::numeric_limits<double>::infinity();
  return mirrored->fit.sum_squares;
}

template class DepthKernel<2>;
template class DepthKernel<3>;

}  // namespace sextant
