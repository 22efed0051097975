// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/explained.h"

#include <utility>

#include "geometry/residuals.h"
#include "solvers/kernels/cloud_sums.h"
#include "solvers/pnp/sqpnp.h"

namespace sextant {
namespace {

// The square of 5 percent.
constexpr double kSmallShare = 0.0025;
// Three pairs fit exactly.
constexpr std::size_t kMinToCheck = 4;

template <class PointAt>
double SquaresAboutMean(std::size_t count, const PointAt& at) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double squares = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector2d arm = at(i) - at(0);
    sum += arm;
    squares += arm.squaredNorm();
  }
  return squares - sum.squaredNorm() / static_cast<double>(count);
}

Expected<void> AskSqpnp(const PnpView& view) {
  Expected<SqpnpFit> fit = SolveSqpnp(view.image_points, view.points);
  if (fit) return {};
  // That no pose of sqpnp explains the pixels says nothing of this one: see CheckPlausible.
  if (fit.error().code != ErrorCode::kMirrored) return {};
  return tl::unexpected<Error>(std::move(fit.error()));
}

}  // namespace

bool IsSmallAgainstImage(std::span<const Pair2d3d> pairs, double sum_squares_px2) {
  // Two pixels are a lower bound of the extent, and mostly enough.
  const double apart = (pairs.front().pixel - pairs.back().pixel).squaredNorm();
  if (sum_squares_px2 <= kSmallShare * 0.5 * apart) return true;
  const double extent = SquaresAboutMean(
      pairs.size(), [&](std::size_t i) -> const Eigen::Vector2d& { return pairs[i].pixel; });
  return sum_squares_px2 <= kSmallShare * extent;
}

Expected<void> CheckExplained(const PnpView& view, const Rigid3d& view_from_lidar) {
  const std::size_t count = view.points.size();
  if (count < kMinToCheck) return {};
  const ImageFit fit =
      FitOf(view.image_points, view.points, view_from_lidar.rotation.toRotationMatrix(),
            view_from_lidar.translation);
  const double extent = SquaresAboutMean(
      count, [&](std::size_t i) -> const Eigen::Vector2d& { return view.image_points[i]; });
  if (fit.behind == 0 && fit.sum_squares <= kSmallShare * extent) return {};
  return AskSqpnp(view);
}

Expected<void> CheckExplained(const Camera& camera, std::span<const Pair2d3d> pairs,
                              const Rigid3d& cam_from_lidar) {
  if (pairs.size() < kMinToCheck) return {};
  double squares = 0.0;
  bool all_project = true;
  for (const Pair2d3d& pair : pairs) {
    const auto residual = ReprojectionResidual(camera, cam_from_lidar, pair);
    all_project = all_project && residual.has_value();
    if (residual) squares += residual->squaredNorm();
  }
  if (all_project && IsSmallAgainstImage(pairs, squares)) return {};
  const Expected<PnpView> view = MakeView(camera, pairs);
  if (!view) return {};
  return AskSqpnp(*view);
}

}  // namespace sextant
