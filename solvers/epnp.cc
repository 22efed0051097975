// SPDX-License-Identifier: Apache-2.0
#include "solvers/epnp.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "solvers/correspondences.h"
#include "solvers/max_trace_rotation.h"
#include "solvers/pnp_solver.h"
#include "solvers/registry.h"

namespace sextant {
namespace {

// Thinner sets than this (standard deviations) are also solved as a plane: pixel noise then says
// more of the third axis than its points do.
constexpr double kThin = 0.05;

/// A pose with the centroid in place of the origin, and how well it explains the image.
struct Candidate {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  ImageFit fit{.behind = std::numeric_limits<std::size_t>::max()};

  bool IsBetterThan(const Candidate& other) const {
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

  /// Candidates are judged by how well they explain the image, or by how near they are to `near`.
  DepthKernel(const Correspondences& data, const Rigid3d* near);

  const Candidate& best() const { return best_; }

  void SearchFromKernel();
  void SearchFromWeakPerspective();
  /// The candidates that the answer `near` may have been.
  void SearchNear();
  /// Starts Gauss-Newton at a pose.
  void SearchFrom(const Rigid3d& cam_from_lidar);
  /// The error of the best improper rotation that the first eigenvector gives; infinite where that
  /// is a proper one.
  double MirroredSumSquares() const;

 private:
  using Square = Eigen::Matrix<double, kDepths, kDepths>;
  using Columns = Eigen::Matrix<double, 3, kDepths>;

  Depths DepthsOf(const Rigid3d& cam_from_lidar) const;
  Columns InCamera(const Depths& z) const;
  Depths Scaled(const Depths& z) const;
  Depths FromTwoEigenvectors() const;
  Depths Refined(Depths z) const;
  bool GaussNewtonStep(Depths& z) const;
  std::optional<Candidate> PoseOf(const Depths& z, bool mirrored) const;
  ImageFit Judge(const Candidate& candidate) const;
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
  Square eigenvectors_;
  static constexpr std::size_t kMaxStarts = 5 + 2 * kMaxP3pPoses;
  std::array<Depths, kMaxStarts> considered_;
  int considered_count_ = 0;
  Candidate best_;
};

template <int kAxes>
DepthKernel<kAxes>::DepthKernel(const Correspondences& data, const Rigid3d* near)
    : data_(data),
      near_(near),
      deviation_(data.frame.deviation.head<kAxes>()),
      mean_(data.moments.mean) {
  Depths whiten;
  whiten << 1.0, deviation_.cwiseInverse();
  const auto whitened = [&whiten](const Eigen::Matrix4d& moment) -> Square {
    return whiten.asDiagonal() * moment.topLeftCorner<kDepths, kDepths>() * whiten.asDiagonal();
  };
  about_u_ = whitened(data.moments.u);
  about_v_ = whitened(data.moments.v);
  x_by_depth_ = about_u_ + mean_.x() * Square::Identity();
  y_by_depth_ = about_v_ + mean_.y() * Square::Identity();
  const Square reduced = whitened(data.moments.w) - about_u_ * about_u_ - about_v_ * about_v_;
  eigenvectors_ = Eigen::SelfAdjointEigenSolver<Square>(reduced).eigenvectors();
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

/// One step on d_j . d_k = delta_jk deviation_j^2; whether it was worth another.
template <int kAxes>
bool DepthKernel<kAxes>::GaussNewtonStep(Depths& z) const {
  const Depths x = x_by_depth_ * z;
  const Depths y = y_by_depth_ * z;
  Square normal = Square::Zero();
  Depths right = Depths::Zero();
  for (int j = 1; j < kDepths; ++j) {
    for (int k = j; k < kDepths; ++k) {
      const double wanted = j == k ? deviation_(j - 1) * deviation_(j - 1) : 0.0;
      const double residual = x(j) * x(k) + y(j) * y(k) + z(j) * z(k) - wanted;
      Depths row = x(k) * x_by_depth_.col(j) + x(j) * x_by_depth_.col(k) +
                   y(k) * y_by_depth_.col(j) + y(j) * y_by_depth_.col(k);
      row(j) += z(k);
      row(k) += z(j);
      normal.noalias() += row * row.transpose();
      right += residual * row;
    }
  }
  normal.diagonal() *= 1.0 + 1e-12;
  const Eigen::LLT<Square> factor(normal);
  if (factor.info() != Eigen::Success) return false;
  const Depths step = factor.solve(right);
  z -= step;
  // Of the turn that the step amounts to.
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
std::optional<Candidate> DepthKernel<kAxes>::PoseOf(const Depths& z, bool mirrored) const {
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

  Candidate candidate;
  candidate.rotation = turned * data_.frame.axes.transpose();
  const Eigen::Matrix<double, 3, kAxes> d = turned.leftCols<kAxes>() * deviation_.asDiagonal();
  // Image points and the rotated cloud, both about their means: u z = x. Multiplied by x (not by
  // the noisy u, which would draw the depth towards the camera) and summed, this gives the depth.
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
ImageFit DepthKernel<kAxes>::Judge(const Candidate& candidate) const {
  if (near_ == nullptr) return FitOf(data_, candidate.rotation, candidate.centroid);
  const Eigen::Vector3d centroid = *near_ * data_.frame.centroid;
  return {.behind = 0,
          .sum_squares = (candidate.rotation - near_->rotation.toRotationMatrix()).squaredNorm() +
                         (candidate.centroid - centroid).squaredNorm() / centroid.squaredNorm()};
}

template <int kAxes>
void DepthKernel<kAxes>::Consider(const Depths& z) {
  // Most starts lead to the same depths.
  constexpr double kSameDepths = 1e-10;
  for (int i = 0; i < considered_count_; ++i) {
    const Depths& other = considered_[static_cast<std::size_t>(i)];
    if ((z - other).squaredNorm() < kSameDepths * deviation_.squaredNorm()) return;
  }
  if (!z.allFinite()) return;
  considered_[static_cast<std::size_t>(considered_count_++)] = z;
  const std::optional<Candidate> candidate = PoseOf(z, /*mirrored=*/false);
  if (candidate && candidate->IsBetterThan(best_)) best_ = *candidate;
}

template <int kAxes>
void DepthKernel<kAxes>::SearchFromKernel() {
  const Depths scaled = Scaled(eigenvectors_.col(0));
  Consider(scaled);
  Consider(Refined(scaled));
  Consider(Refined(FromTwoEigenvectors()));
}

/// All points at the depth of the centroid give the first two rows of the rotation and that depth;
/// the third row follows but for the sign of its slope.
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
  const std::optional<Candidate> mirrored = PoseOf(z, /*mirrored=*/true);
  if (!mirrored || mirrored->fit.behind > 0) return std::numeric_limits<double>::infinity();
  return mirrored->fit.sum_squares;
}

/// Tries every start, and gives the error of the best improper rotation.
template <int kAxes>
double Search(const Correspondences& data, const Rigid3d* near, Candidate& best) {
  DepthKernel<kAxes> kernel(data, near);
  if (near != nullptr) {
    kernel.SearchNear();
  } else {
    kernel.SearchFromKernel();
    kernel.SearchFromWeakPerspective();
  }
  if (data.frame.different_count == 4) {
    const TrianglePoses found = PosesOfWidestTriangle(data);
    for (int i = 0; i < found.count; ++i) {
      kernel.SearchFrom(found.poses[static_cast<std::size_t>(i)]);
    }
  }
  if (kernel.best().IsBetterThan(best)) best = kernel.best();
  return kernel.MirroredSumSquares();
}

/// Whether the best candidate is an answer.
Expected<void> Check(const Correspondences& data, const Candidate& best, double mirrored) {
  const std::size_t count = data.points.size();
  const double spread = data.moments.Spread() * static_cast<double>(count);
  const bool explained = best.fit.behind <= count / 2 && best.fit.sum_squares <= spread;
  const double error = explained ? best.fit.sum_squares : spread;
  if (error > MirrorRatio(count) * mirrored + 1e-12 * spread) return MirroredError();
  if (!explained) return UnexplainedError();
  return {};
}

}  // namespace

Expected<EpnpFit> SolveEpnp(std::span<const Eigen::Vector2d> image_points,
                            std::span<const Eigen::Vector3d> points_in_lidar,
                            const PnpChoice& choice) {
  constexpr std::size_t kMinPoints = 4;
  const Expected<Correspondences> data =
      PrepareCorrespondences(image_points, points_in_lidar, kMinPoints);
  if (!data) return tl::unexpected<Error>(data.error());
  const PointCloudFrame& frame = data->frame;
  Candidate best;
  double mirrored = std::numeric_limits<double>::infinity();
  if (!frame.IsPlanar()) mirrored = Search<3>(*data, choice.near, best);
  if (frame.deviation.z() < kThin * frame.deviation.x()) Search<2>(*data, choice.near, best);
  if (choice.near != nullptr) {
    best.fit = FitOf(*data, best.rotation, best.centroid);
  } else if (Expected<void> ok = Check(*data, best, mirrored); !ok && !choice.unchecked) {
    return tl::unexpected<Error>(std::move(ok.error()));
  }
  PolishIfExact(*data, best.fit, best.rotation, best.centroid);
  EpnpFit fit;
  fit.cam_from_lidar.rotation = Eigen::Quaterniond(best.rotation).normalized();
  fit.cam_from_lidar.translation = best.centroid - fit.cam_from_lidar.rotation * frame.centroid;
  fit.sum_squares = best.fit.sum_squares;
  return fit;
}

SolverEntry EpnpEntry() {
  return {
      .name = "epnp",
      .summary = "pose from control points: kernel of the linear equations, then their lengths",
      .needs = "4 or more 2D-3D pairs, not on one line",
      .reference = "Lepetit, Moreno-Noguer and Fua 2009 (IJCV)",
      .example = "epnp",
      .make = [](const SolverArguments& arguments) -> Expected<SolverPtr> {
        return std::make_shared<PnpSolver>(
            SolverSpec{.name = arguments.name, .needs = {.pairs_2d3d = 4}},
            [](const PnpInput& input) -> Expected<PnpPoses> {
              const Expected<EpnpFit> fit =
                  SolveEpnp(input.image_points, input.points, input.choice);
              if (!fit) return tl::unexpected<Error>(fit.error());
              return PnpPoses{.poses = {fit->cam_from_lidar}, .count = 1};
            },
            PnpCovariance::kMoments);
      },
  };
}

}  // namespace sextant
