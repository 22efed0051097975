// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/explained.h"

#include <Eigen/Geometry>
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

// Sum of the squared distances of the pixels from their mean.
double ExtentOf(std::span<const Pair2d3d> pairs) {
  return SquaresAboutMean(pairs.size(),
                          [&](std::size_t i) -> const Eigen::Vector2d& { return pairs[i].pixel; });
}

// Square of three quarters. A pose that projects all points onto one pixel leaves 43 percent of
// normally distributed pixels within this share of their squared spread.
constexpr double kNearShare = 0.5625;

/// Counts the pairs that a pose leaves within three quarters of the spread of the pixels.
class WellExplained {
 public:
  WellExplained(std::size_t count, double extent)
      : count_(count), near_(kNearShare * extent / static_cast<double>(count)) {}

  void Add(double squared) {
    if (squared <= near_) ++near_count_;
  }
  // Half or more, besides the three that a pose fits whatever they are.
  bool AreHalf() const { return 2 * near_count_ >= count_ + kAbsorbed; }

 private:
  static constexpr std::size_t kAbsorbed = 3;

  std::size_t count_;
  double near_;
  std::size_t near_count_ = 0;
};

// A pose that explains half of the pairs shows what sqpnp did not find.
Expected<void> AskSqpnp(const PnpView& view, const WellExplained& pairs) {
  Expected<SqpnpFit> fit = SolveSqpnp(view.image_points, view.points);
  if (fit) return {};
  const ErrorCode code = fit.error().code;
  const bool refutes =
      code == ErrorCode::kMirrored || (code == ErrorCode::kNoConsensus && !pairs.AreHalf());
  if (!refutes) return {};
  return tl::unexpected<Error>(std::move(fit.error()));
}

}  // namespace

bool IsSmallAgainstImage(std::span<const Pair2d3d> pairs, double sum_squares_px2) {
  // Two pixels are a lower bound of the extent, and mostly enough.
  const double apart = (pairs.front().pixel - pairs.back().pixel).squaredNorm();
  if (sum_squares_px2 <= kSmallShare * 0.5 * apart) return true;
  return sum_squares_px2 <= kSmallShare * ExtentOf(pairs);
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
  WellExplained explained(count, extent);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d in_view = view_from_lidar * view.points[i];
    if (in_view.z() <= 0.0) continue;
    explained.Add((in_view.hnormalized() - view.image_points[i]).squaredNorm());
  }
  return AskSqpnp(view, explained);
}

Expected<void> CheckExplained(const Camera& camera, std::span<const Pair2d3d> pairs,
                              const Rigid3d& cam_from_lidar) {
  if (pairs.size() < kMinToCheck) return {};
  WellExplained explained(pairs.size(), ExtentOf(pairs));
  double squares = 0.0;
  bool all_project = true;
  for (const Pair2d3d& pair : pairs) {
    const auto residual = ReprojectionResidual(camera, cam_from_lidar, pair);
    all_project = all_project && residual.has_value();
    if (!residual) continue;
    squares += residual->squaredNorm();
    explained.Add(residual->squaredNorm());
  }
  if (all_project && IsSmallAgainstImage(pairs, squares)) return {};
  const Expected<PnpView> view = MakeView(camera, pairs);
  if (!view) return {};
  return AskSqpnp(*view, explained);
}

}  // namespace sextant
