// SPDX-License-Identifier: Apache-2.0
#include "solvers/robust/pose_scorer.h"

#include <algorithm>

#include "solvers/kernels/pixel_sums.h"

namespace sextant {
namespace {

constexpr double kNotProjected = std::numeric_limits<double>::infinity();

}  // namespace

// Calls visit(r_i^2) in order until it returns false.
template <class Visit>
void PoseScorer::ForEach(const Rigid3d& cam_from_lidar, Visit&& visit) const {
  const Eigen::Matrix3d r = cam_from_lidar.rotation.toRotationMatrix();
  const Eigen::Vector3d& t = cam_from_lidar.translation;
  for (const PointTerm& term : terms_->points) {
    const Eigen::Vector3d residual = term.in_cam - (r * term.in_lidar + t);
    if (!visit((term.whitener * residual).squaredNorm())) return;
  }
  const Camera& camera = terms_->camera;
  if (camera.model == CameraModel::kPinhole) {
    const PinholePose pose(camera, cam_from_lidar);
    std::size_t left = terms_->pixels.size();
    for (const PixelBlock& block : terms_->pixels.blocks()) {
      double squared[kSimdWidth];
      SquarePixels(std::span(&block, 1), pose, squared);
      for (std::size_t k = 0; k < std::min(left, kSimdWidth); ++k) {
        if (!visit(squared[k])) return;
      }
      left -= std::min(left, kSimdWidth);
    }
    return;
  }
  for (const PixelTerm term : terms_->pixels) {
    const std::optional<Eigen::Vector2d> projected = Project(camera, r * term.in_lidar + t);
    const double squared = projected ? (term.pixel - *projected).squaredNorm() *
                                           term.inverse_sigma * term.inverse_sigma
                                     : kNotProjected;
    if (!visit(squared)) return;
  }
}

double PoseScorer::Cost(const Rigid3d& cam_from_lidar, double give_up) const {
  if (terms_->points.empty() && terms_->camera.model == CameraModel::kPinhole) {
    return TruncatedPixelCost(terms_->pixels.blocks(), PinholePose(terms_->camera, cam_from_lidar),
                              max_squared_, give_up);
  }
  double cost = 0.0;
  ForEach(cam_from_lidar, [&](double squared) {
    // A residual that is not a number counts as an outlier's.
    cost += squared < max_squared_ ? squared : max_squared_;
    return cost < give_up;
  });
  return cost;
}

void PoseScorer::SquaredResiduals(const Rigid3d& cam_from_lidar, std::span<double> squared) const {
  std::size_t i = 0;
  ForEach(cam_from_lidar, [&](double value) {
    squared[i++] = value;
    return true;
  });
}

void PoseScorer::Inliers(const Rigid3d& cam_from_lidar, std::vector<int>& inliers,
                         double widening) const {
  const double max_squared = widening * max_squared_;
  inliers.clear();
  int i = 0;
  ForEach(cam_from_lidar, [&](double squared) {
    if (squared <= max_squared) inliers.push_back(i);
    ++i;
    return true;
  });
}

}  // namespace sextant
