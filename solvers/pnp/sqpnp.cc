// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/sqpnp.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "solvers/core/mirror_image.h"
#include "solvers/core/registry.h"
#include "solvers/kernels/max_trace_rotation.h"
#include "solvers/pnp/correspondences.h"
#include "solvers/pnp/pnp_solver.h"
#include "solvers/pnp/rotation_cost.h"

namespace sextant {
namespace {

// Cost of exact data from rounding, relative to the variance of the points, with a wide margin.
constexpr double kRounding = 1e-12;

// Sets thinner than this ratio of standard deviations have two minima when far away.
constexpr double kThin = 0.05;

// With up to five points omega has a kernel of two or more dimensions, whose basis is a poor start;
// so it is for some larger sets, which then fit badly. The P3P poses of three points are starts
// too.
constexpr int kMaxForTriangle = 5;
constexpr double kWellExplained = 1e-3;

/// A minimum, in principal axes.
struct Minimum {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  double cost = 0.0;
  ImageFit fit;
};

/// The different minima found so far, in ascending order of cost, and the lowest of those with
/// points behind the camera.
class Minima {
 public:
  Minima(const Correspondences& data, const RotationCost& cost) : data_(data), cost_(cost) {}

  void SearchFrom(const Eigen::Matrix3d& start);
  std::span<const Minimum> found() const { return std::span(found_).first(count_); }
  double best_cost() const {
    if (count_ == 0) return kNone;
    return found_[0].cost;
  }
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
  double best_depth_behind_ = 0.0;  ///< Depth of the centroid at that minimum.
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
  // Where no pose in front fits, the comparison is with a single image point for all.
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
    // Every rotation composed of this and the later eigenvectors costs at least this.
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

/// A flat set has a second minimum near its mirror image.
void SearchFromMirrorImage(Minima& minima) {
  if (minima.found().empty()) return;
  const Minimum& best = minima.found()[0];
  minima.SearchFrom(
      MirroredRotation(best.rotation, Eigen::Vector3d::UnitZ(), best.centroid.normalized()));
}

}  // namespace

Expected<SqpnpFit> SolveSqpnp(std::span<const Eigen::Vector2d> image_points,
                              std::span<const Eigen::Vector3d> points_in_lidar,
                              const PnpChoice& choice) {
  constexpr std::size_t kMinPoints = 3;
  SEXTANT_ASSIGN_OR_RETURN(const Correspondences& data,
                           PrepareCorrespondences(image_points, points_in_lidar, kMinPoints));
  const RotationCost cost(data);
  Minima minima(data, cost);
  const PointCloudFrame& frame = data.frame;
  if (frame.different_count > 3) {
    if (frame.IsPlanar()) {
      SearchFromEigenvectors<2>(cost, minima);
    } else {
      SearchFromEigenvectors<3>(cost, minima);
    }
    if (frame.deviation.z() < kThin * frame.deviation.x()) SearchFromMirrorImage(minima);
  }
  if (frame.different_count <= kMaxForTriangle || !minima.ExplainImage(kWellExplained)) {
    const TrianglePoses found = PosesOfWidestTriangle(data);
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
    PolishIfExact(data, minimum.fit, rotation, minimum.centroid);
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
              SEXTANT_ASSIGN_OR_RETURN(const SqpnpFit fit,
                                       SolveSqpnp(input.image_points, input.points, input.choice));
              return PnpPoses{.poses = fit.cam_from_lidar, .count = fit.count};
            },
            PnpCovariance::kObjectSpace, WideViews::kLeastSquares);
      },
  };
}

}  // namespace sextant
