// SPDX-License-Identifier: Apache-2.0
#include "solvers/core/local_frame.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "base/units.h"
#include "geometry/so3.h"

namespace sextant {
namespace {

// Distance from the origin over extent, above which coordinates are moved.
constexpr double kMaxOffset = 100.0;
// The same ratio, above which the sigma of the translation is explained.
constexpr double kFarOffset = 1000.0;
constexpr double kMinExtent_m = 1e-2;
constexpr double kMaxExtent_m = 1e3;

// Points by index, whatever holds them.
template <class Get>
class Cloud {
 public:
  Cloud(std::size_t size, Get get) : size_(size), get_(get) {}

  // From three of the points. False only means that the sums must be computed.
  bool IsOrdinary() const {
    if (size_ == 0) return true;
    const Eigen::Vector3d& first = get_(0);
    const double extent2 =
        std::max((get_(size_ / 2) - first).squaredNorm(), (get_(size_ - 1) - first).squaredNorm());
    return first.squaredNorm() < 0.25 * kMaxOffset * kMaxOffset * extent2 &&
           extent2 > 4.0 * kMinExtent_m * kMinExtent_m &&
           extent2 < 0.25 * kMaxExtent_m * kMaxExtent_m;
  }

  Eigen::Vector3d Centre() const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < size_; ++i) sum += get_(i) - get_(0);
    return get_(0) + sum / static_cast<double>(size_);
  }

  // Root mean square distance from `centre`.
  double Extent(const Eigen::Vector3d& centre) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < size_; ++i) sum += (get_(i) - centre).squaredNorm();
    return std::sqrt(sum / static_cast<double>(size_));
  }

 private:
  std::size_t size_;
  Get get_;
};

// A centre far from the origin, and the extent about it.
struct Placement {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double extent_m = 1.0;
  double offset = 0.0;  // Distance from the origin over extent.
};

template <class Get>
Placement PlacementOf(std::size_t size, Get get) {
  const Cloud cloud(size, get);
  Placement placement;
  if (cloud.IsOrdinary()) return placement;
  const Eigen::Vector3d centre = cloud.Centre();
  placement.extent_m = cloud.Extent(centre);
  placement.offset = placement.extent_m > 0.0 ? centre.norm() / placement.extent_m : 0.0;
  if (placement.offset > kMaxOffset && centre.allFinite()) placement.centre = centre;
  return placement;
}

Placement PlacementOf(std::span<const Eigen::Vector3d> points) {
  return PlacementOf(points.size(),
                     [points](std::size_t i) -> const Eigen::Vector3d& { return points[i]; });
}

Placement LidarPlacement(const CalibrationProblem& problem, const DataNeeds& needs) {
  const auto& pairs_3d3d = problem.pairs_3d3d;
  const auto& pairs_2d3d = problem.pairs_2d3d;
  if (needs.pairs_3d3d > 0) {
    return PlacementOf(pairs_3d3d.size(), [&](std::size_t i) -> const Eigen::Vector3d& {
      return pairs_3d3d[i].point_in_lidar;
    });
  }
  if (needs.pairs_2d3d > 0) {
    return PlacementOf(pairs_2d3d.size(), [&](std::size_t i) -> const Eigen::Vector3d& {
      return pairs_2d3d[i].point_in_lidar;
    });
  }
  return PlacementOf(problem.point_sets.in_lidar);
}

Placement CamPlacement(const CalibrationProblem& problem, const DataNeeds& needs) {
  const auto& pairs = problem.pairs_3d3d;
  if (needs.pairs_3d3d > 0) {
    return PlacementOf(pairs.size(), [&](std::size_t i) -> const Eigen::Vector3d& {
      return pairs[i].point_in_cam;
    });
  }
  return PlacementOf(problem.point_sets.in_cam);
}

double UnitFor(double extent_m) {
  const bool is_ordinary = extent_m > kMinExtent_m && extent_m < kMaxExtent_m;
  if (is_ordinary || !(extent_m > 0.0) || !std::isfinite(extent_m)) return 1.0;
  return std::exp2(std::round(std::log2(extent_m)));
}

// dt' of a pose about an origin that is moved by `arm`, which the rotation has turned already.
Matrix6d MoveOrigin(const Eigen::Vector3d& arm) {
  Matrix6d move = Matrix6d::Identity();
  move.bottomLeftCorner<3, 3>() = Hat(arm);
  return move;
}

std::string FarOriginNote(const Eigen::Vector3d& centre, const Estimate& local, double unit_m) {
  const std::string where =
      fmt::format("the points are about {:.3g} m from the LiDAR's origin, ({:.6g}, {:.6g}, {:.6g})",
                  centre.norm(), centre.x(), centre.y(), centre.z());
  if (!local.covariance) return where + "; the translation is that of this far origin";
  const Vector6d sigma = local.covariance->diagonal().cwiseMax(0.0).cwiseSqrt();
  return fmt::format(
      "{}; the sigma of the translation is that of this far origin, which the rotation's error "
      "moves; at the centre of the points it is {:.3g} {:.3g} {:.3g} mm",
      where, unit_m * sigma[3] * kMmPerM, unit_m * sigma[4] * kMmPerM, unit_m * sigma[5] * kMmPerM);
}

}  // namespace

std::optional<LocalFrame> LocalFrame::For(const CalibrationProblem& problem,
                                          const DataNeeds& needs) {
  if (needs.board_views > 0) return std::nullopt;
  const Placement lidar = LidarPlacement(problem, needs);
  LocalFrame frame;
  frame.lidar_centre_ = lidar.centre;
  frame.is_far_ = lidar.offset > kFarOffset;
  if (needs.pairs_2d3d == 0 && problem.pairs_2d3d.empty()) {
    frame.cam_centre_ = CamPlacement(problem, needs).centre;
  } else if (problem.pairs_3d3d.empty() && problem.point_sets.in_lidar.empty()) {
    frame.unit_m_ = UnitFor(lidar.extent_m);
  }
  const bool is_moved = !frame.lidar_centre_.isZero(0.0) || !frame.cam_centre_.isZero(0.0);
  if (!is_moved && frame.unit_m_ == 1.0) return std::nullopt;
  return frame;
}

CalibrationProblem LocalFrame::Localised(const CalibrationProblem& problem) const {
  const double per_unit = 1.0 / unit_m_;
  const auto in_lidar = [&](Eigen::Vector3d& p) { p = per_unit * (p - lidar_centre_); };
  const auto in_cam = [&](Eigen::Vector3d& p) { p -= cam_centre_; };
  CalibrationProblem local = problem;
  for (Pair3d3d& pair : local.pairs_3d3d) {
    in_lidar(pair.point_in_lidar);
    in_cam(pair.point_in_cam);
  }
  for (Pair2d3d& pair : local.pairs_2d3d) in_lidar(pair.point_in_lidar);
  for (Eigen::Vector3d& point : local.point_sets.in_lidar) in_lidar(point);
  for (Eigen::Vector3d& point : local.point_sets.in_cam) in_cam(point);
  if (local.initial_cam_from_lidar) {
    Rigid3d& pose = *local.initial_cam_from_lidar;
    pose.translation = per_unit * (pose * lidar_centre_ - cam_centre_);
  }
  return local;
}

Rigid3d LocalFrame::Restored(const Rigid3d& local) const {
  return {local.rotation,
          unit_m_ * local.translation + cam_centre_ - local.rotation * lidar_centre_};
}

void LocalFrame::Restore(Estimate& estimate) const {
  if (is_far_) estimate.warnings.push_back(FarOriginNote(lidar_centre_, estimate, unit_m_));
  if (estimate.covariance) {
    Vector6d units = Vector6d::Ones();
    units.tail<3>().setConstant(unit_m_);
    const Matrix6d back =
        MoveOrigin(estimate.cam_from_lidar.rotation * lidar_centre_) * units.asDiagonal();
    *estimate.covariance = back * *estimate.covariance * back.transpose();
  }
  estimate.cam_from_lidar = Restored(estimate.cam_from_lidar);
  for (Rigid3d& pose : estimate.alternatives) pose = Restored(pose);
  for (Stage& stage : estimate.stages) stage.cam_from_lidar = Restored(stage.cam_from_lidar);
}

}  // namespace sextant
