// SPDX-License-Identifier: Apache-2.0
#include "solvers/sqpnp.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "solvers/correspondences.h"
#include "solvers/max_trace_rotation.h"
#include "solvers/pnp_solver.h"
#include "solvers/registry.h"

namespace sextant {
namespace {

using Vector9d = Eigen::Matrix<double, 9, 1>;
using Matrix9d = Eigen::Matrix<double, 9, 9>;

// Costs of exact data, relative to the points' variance, with a wide margin.
constexpr double kRounding = 1e-12;

// Thinner sets than this (standard deviations) have two minima when far away.
constexpr double kThin = 0.05;

// Up to five points leave omega a kernel of two or more dimensions, whose basis says little of the
// rotation, and so do a few others by chance, which then fit badly: poses of three of the points
// are starts too.
constexpr int kMaxForTriangle = 5;
constexpr double kWellExplained = 1e-3;

/// The cost mean_i |x_i - u_i z_i|^2 + |y_i - v_i z_i|^2 = r^T omega r, with the entries of the
/// rotation (camera from principal axes) row by row in r, and the centroid that goes with it.
class RotationCost {
 public:
  explicit RotationCost(const Correspondences& data);

  const Matrix9d& omega() const { return omega_; }
  double operator()(const Eigen::Matrix3d& rotation) const;
  Eigen::Vector3d Centroid(const Eigen::Matrix3d& rotation) const;
  /// Descends to the nearest minimum.
  Eigen::Matrix3d Minimize(Eigen::Matrix3d rotation) const;

 private:
  Matrix9d omega_;
  Eigen::Matrix<double, 3, 9> centroid_by_rotation_;
};

Vector9d Entries(const Eigen::Matrix3d& rotation) {
  Vector9d entries;
  entries << rotation.row(0).transpose(), rotation.row(1).transpose(), rotation.row(2).transpose();
  return entries;
}

RotationCost::RotationCost(const Correspondences& data) {
  const ImageMoments& m = data.moments;
  const Eigen::Vector3d u0 = m.u.topRightCorner<1, 3>().transpose();
  const Eigen::Vector3d v0 = m.v.topRightCorner<1, 3>().transpose();
  const Eigen::Vector3d w0 = m.w.topRightCorner<1, 3>().transpose();
  // In camera coordinates x' = x - u_mean z, y' = y - v_mean z the image points are about their
  // mean, and the best centroid is x' = u0 . r3, y' = v0 . r3, z = depth . r.
  Vector9d depth;
  depth << u0, v0, -w0;
  depth /= m.Spread();
  const Eigen::Matrix3d squares = data.frame.deviation.cwiseAbs2().asDiagonal();
  omega_.setZero();
  omega_.block<3, 3>(0, 0) = squares;
  omega_.block<3, 3>(3, 3) = squares;
  omega_.block<3, 3>(0, 6) = -m.u.bottomRightCorner<3, 3>();
  omega_.block<3, 3>(3, 6) = -m.v.bottomRightCorner<3, 3>();
  omega_.block<3, 3>(6, 0) = omega_.block<3, 3>(0, 6);
  omega_.block<3, 3>(6, 3) = omega_.block<3, 3>(3, 6);
  omega_.block<3, 3>(6, 6) =
      m.w.bottomRightCorner<3, 3>() - u0 * u0.transpose() - v0 * v0.transpose();
  omega_ -= m.Spread() * depth * depth.transpose();

  // From those coordinates back to the camera's, on both sides.
  const Eigen::Vector2d mean = m.mean;
  omega_.rightCols<3>() -= mean.x() * omega_.leftCols<3>() + mean.y() * omega_.middleCols<3>(3);
  omega_.bottomRows<3>() -= mean.x() * omega_.topRows<3>() + mean.y() * omega_.middleRows<3>(3);
  Vector9d z = depth;
  z.tail<3>() -= mean.x() * depth.head<3>() + mean.y() * depth.segment<3>(3);
  centroid_by_rotation_.row(0) = mean.x() * z.transpose();
  centroid_by_rotation_.row(1) = mean.y() * z.transpose();
  centroid_by_rotation_.row(2) = z.transpose();
  centroid_by_rotation_.block<1, 3>(0, 6) += u0.transpose();
  centroid_by_rotation_.block<1, 3>(1, 6) += v0.transpose();
}

double RotationCost::operator()(const Eigen::Matrix3d& rotation) const {
  const Vector9d r = Entries(rotation);
  return std::max(0.0, r.dot(omega_ * r));
}

Eigen::Vector3d RotationCost::Centroid(const Eigen::Matrix3d& rotation) const {
  return centroid_by_rotation_ * Entries(rotation);
}

Eigen::Matrix3d RotationCost::Minimize(Eigen::Matrix3d rotation) const {
  constexpr int kMaxSteps = 15;
  constexpr double kSmallStep = 1e-8;
  for (int i = 0; i < kMaxSteps; ++i) {
    const Eigen::Vector3d r1 = rotation.row(0);
    const Eigen::Vector3d r2 = rotation.row(1);
    const Eigen::Vector3d r3 = rotation.row(2);
    // Derivative of the entries by a turn omega: row k of Hat(omega) R.
    Eigen::Matrix<double, 9, 3> turn = Eigen::Matrix<double, 9, 3>::Zero();
    turn.block<3, 1>(0, 1) = r3;
    turn.block<3, 1>(0, 2) = -r2;
    turn.block<3, 1>(3, 0) = -r3;
    turn.block<3, 1>(3, 2) = r1;
    turn.block<3, 1>(6, 0) = r2;
    turn.block<3, 1>(6, 1) = -r1;
    const Vector9d slope = omega_ * Entries(rotation);
    const Eigen::Vector3d gradient = turn.transpose() * slope;
    const Eigen::Matrix<double, 9, 3> turned_slope = omega_.lazyProduct(turn);
    const Eigen::Matrix3d convex = turn.transpose().lazyProduct(turned_slope);
    // Second order of Exp(omega) R against the slope: the curvature of the constraints.
    const Eigen::Matrix3d product = rotation * Eigen::Map<const Eigen::Matrix3d>(slope.data());
    Eigen::Matrix3d hessian = convex + 0.5 * (product + product.transpose());
    hessian.diagonal().array() -= product.trace();
    Eigen::LLT<Eigen::Matrix3d> factor(hessian);
    if (factor.info() != Eigen::Success) factor.compute(convex);
    if (factor.info() != Eigen::Success) break;
    const Eigen::Vector3d step = -factor.solve(gradient);
    const Eigen::Quaterniond turned(1.0, 0.5 * step.x(), 0.5 * step.y(), 0.5 * step.z());
    rotation = turned.normalized() * rotation;
    if (step.squaredNorm() < kSmallStep * kSmallStep) break;
  }
  return rotation;
}

/// A minimum, in principal axes.
struct Minimum {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  double cost = 0.0;
  ImageFit fit;
};

/// The different minima found so far, in ascending order of cost, and the least of those that have
/// points behind the camera.
class Minima {
 public:
  Minima(const Correspondences& data, const RotationCost& cost) : data_(data), cost_(cost) {}

  void SearchFrom(const Eigen::Matrix3d& start);
  std::span<const Minimum> found() const { return std::span(found_).first(count_); }
  double best_cost() const { return count_ > 0 ? found_[0].cost : kNone; }
  /// Whether the best leaves less than `share` of the image points' squared distance from their
  /// mean.
  bool ExplainImage(double share) const {
    if (count_ == 0) return false;
    const double depth = found_[0].centroid.z();
    return found_[0].cost <= share * data_.moments.Spread() * depth * depth;
  }
  /// Whether a pose with the points behind the camera explains the image far better.
  bool AreMirrored() const;

 private:
  void Sort();

  static constexpr double kNone = std::numeric_limits<double>::infinity();

  const Correspondences& data_;
  const RotationCost& cost_;
  std::array<Minimum, kMaxSqpnpPoses> found_;
  std::size_t count_ = 0;
  double best_cost_behind_ = kNone;
  double best_depth_behind_ = 0.0;  ///< Of the centroid, of that minimum.
};

void Minima::Sort() {
  std::sort(found_.begin(), found_.begin() + static_cast<std::ptrdiff_t>(count_),
            [](const Minimum& a, const Minimum& b) { return a.cost < b.cost; });
}

void Minima::SearchFrom(const Eigen::Matrix3d& start) {
  Minimum minimum;
  minimum.rotation = cost_.Minimize(start);
  minimum.cost = cost_(minimum.rotation);
  minimum.centroid = cost_.Centroid(minimum.rotation);
  if (!(minimum.cost < kNone)) return;
  constexpr double kSameRotation = 1e-8;
  for (Minimum& other : std::span(found_).first(count_)) {
    if ((minimum.rotation - other.rotation).squaredNorm() > kSameRotation) continue;
    minimum.fit = other.fit;
    if (minimum.cost < other.cost) other = minimum;
    Sort();
    return;
  }
  if (minimum.cost >= best_cost() && count_ == found_.size()) return;
  minimum.fit = FitOf(data_, minimum.rotation * data_.frame.axes.transpose(), minimum.centroid);
  const std::size_t most_behind = data_.points.size() < 5 ? 0 : data_.points.size() / 2;
  if (minimum.fit.behind > most_behind) {
    if (minimum.cost < best_cost_behind_) {
      best_cost_behind_ = minimum.cost;
      best_depth_behind_ = minimum.centroid.z();
    }
    return;
  }
  if (count_ < found_.size()) ++count_;
  found_[count_ - 1] = minimum;
  Sort();
}

bool Minima::AreMirrored() const {
  if (best_cost_behind_ == kNone) return false;
  // Where no pose in front fits, one image point for all is what there is to compare with.
  const double single = data_.moments.Spread() * best_depth_behind_ * best_depth_behind_;
  const double rounding = kRounding * data_.frame.deviation.squaredNorm();
  return std::min(best_cost(), single) >
         MirrorRatio(data_.points.size()) * best_cost_behind_ + rounding;
}

/// Starts from the eigenvectors of omega for the first kColumns columns of the rotation: all three,
/// or two for a plane, whose cost does not depend on the third.
template <int kColumns>
void SearchFromEigenvectors(const RotationCost& cost, Minima& minima) {
  constexpr int kEntries = 3 * kColumns;
  Eigen::Matrix<double, kEntries, kEntries> omega;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      omega.template block<kColumns, kColumns>(kColumns * row, kColumns * column) =
          cost.omega().template block<kColumns, kColumns>(3 * row, 3 * column);
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, kEntries, kEntries>> eigen(omega);
  for (int i = 0; i < kEntries; ++i) {
    // No rotation made of this and the later eigenvectors costs less.
    if (kColumns * eigen.eigenvalues()(i) > minima.best_cost()) break;
    Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
    cross.topRows<kColumns>() =
        Eigen::Map<const Eigen::Matrix<double, kColumns, 3>>(eigen.eigenvectors().col(i).data());
    for (const double sign : {1.0, -1.0}) {
      const std::optional<MaxTraceRotation> start = MaximizeTrace(sign * cross, std::sqrt(3.0));
      if (start) minima.SearchFrom(start->rotation.toRotationMatrix());
    }
  }
}

/// A flat set has a second minimum near its mirror image in a plane across the line of sight.
void SearchFromMirrorImage(Minima& minima) {
  if (minima.found().empty()) return;
  const Minimum& best = minima.found()[0];
  const Eigen::Vector3d sight = best.centroid.normalized();
  const Eigen::Matrix3d reflection = Eigen::Matrix3d::Identity() - 2.0 * sight * sight.transpose();
  const Eigen::Vector3d flip(1.0, 1.0, -1.0);
  minima.SearchFrom(reflection * best.rotation * flip.asDiagonal());
}

}  // namespace

Expected<SqpnpFit> SolveSqpnp(std::span<const Eigen::Vector2d> image_points,
                              std::span<const Eigen::Vector3d> points_in_lidar,
                              const PnpChoice& choice) {
  constexpr std::size_t kMinPoints = 3;
  const Expected<Correspondences> data =
      PrepareCorrespondences(image_points, points_in_lidar, kMinPoints);
  if (!data) return tl::unexpected<Error>(data.error());
  const RotationCost cost(*data);
  Minima minima(*data, cost);
  const PointCloudFrame& frame = data->frame;
  if (frame.different_count > 3) {
    if (frame.IsPlanar()) {
      SearchFromEigenvectors<2>(cost, minima);
    } else {
      SearchFromEigenvectors<3>(cost, minima);
    }
    if (frame.deviation.z() < kThin * frame.deviation.x()) SearchFromMirrorImage(minima);
  }
  if (frame.different_count <= kMaxForTriangle || !minima.ExplainImage(kWellExplained)) {
    const TrianglePoses found = PosesOfWidestTriangle(*data);
    for (int i = 0; i < found.count; ++i) {
      const Rigid3d& pose = found.poses[static_cast<std::size_t>(i)];
      minima.SearchFrom(pose.rotation * frame.axes);
    }
  }

  const double trace = frame.deviation.squaredNorm();
  if (!choice.unchecked) {
    if (minima.AreMirrored()) return MirroredError();
    if (!minima.ExplainImage(1.0)) return UnexplainedError();
  }
  const auto count = static_cast<double>(points_in_lidar.size());
  SqpnpFit fit;
  for (Minimum minimum : minima.found()) {
    if (minimum.cost > 2.0 * minima.best_cost() + kRounding * trace) break;
    Eigen::Matrix3d rotation = minimum.rotation * frame.axes.transpose();
    PolishIfExact(*data, minimum.fit, rotation, minimum.centroid);
    const auto at = static_cast<std::size_t>(fit.count++);
    Rigid3d& pose = fit.cam_from_lidar[at];
    pose.rotation = Eigen::Quaterniond(rotation).normalized();
    pose.translation = minimum.centroid - pose.rotation * frame.centroid;
    fit.sum_squares[at] = count * minimum.cost;
  }
  if (fit.count == 0) return UnexplainedError();
  return fit;
}

SolverEntry SqpnpEntry() {
  return {
      .name = "sqpnp",
      .summary = "global least squares of the distances from the lines of sight, times depth",
      .needs = "3 or more 2D-3D pairs, not on one line; with 3 the answer is ambiguous",
      .reference = "Terzakis and Lourakis 2020 (ECCV)",
      .example = "sqpnp",
      .make = [](const SolverArguments& arguments) -> Expected<SolverPtr> {
        return std::make_shared<PnpSolver>(
            SolverSpec{.name = arguments.name, .needs = {.pairs_2d3d = 3}},
            [](const PnpInput& input) -> Expected<PnpPoses> {
              const Expected<SqpnpFit> fit =
                  SolveSqpnp(input.image_points, input.points, input.choice);
              if (!fit) return tl::unexpected<Error>(fit.error());
              return PnpPoses{.poses = fit->cam_from_lidar, .count = fit->count};
            },
            PnpCovariance::kObjectSpace);
      },
  };
}

}  // namespace sextant
