// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "geometry/point_cloud.h"
#include "geometry/rigid3d.h"

namespace sextant {

class PointTree;

/// All finite points of the clouds in one frame, cloud by cloud. Intensities are kept if every
/// cloud has them; rings and times are dropped, as they belong to one sensor. Requires one pose
/// target_from_cloud per cloud.
PointCloud FuseClouds(std::span<const PointCloud> clouds,
                      std::span<const Rigid3d> target_from_cloud);

/// Distance between two clouds of the same place, where both have measured the same surface.
struct CloudAgreement {
  int points = 0;    ///< Number of finite points of `a` that were examined.
  int compared = 0;  ///< How many of them are near a flat patch of `b`.
  /// Median and RMS of the distances to these patches [m] along their normals; NaN if nothing was
  /// compared.
  double median_m = 0.0;
  double rms_m = 0.0;

  double Overlap() const { return points == 0 ? 0.0 : 1.0 * compared / points; }
};

struct AgreementOptions {
  double reach_m = 0.2;  ///< Points of `a` farther than this from every point of `b` are ignored.
  /// A patch is the plane through this many nearest points of `b`. It is flat if the points' spread
  /// along its normal is at most `flatness` times their second largest extent.
  int neighbours = 12;
  double flatness = 0.2;
  /// At most this many points of `a`, evenly chosen; more only take longer.
  int max_points = 20'000;
};

/// A cloud that others are compared with, as often as one likes: it is searched by a tree that is
/// built once, which takes longer than a comparison.
class ReferenceCloud {
 public:
  explicit ReferenceCloud(const PointCloud& cloud);
  ReferenceCloud(ReferenceCloud&& other) noexcept;
  ReferenceCloud& operator=(ReferenceCloud&& other) noexcept;
  ~ReferenceCloud();

  const std::vector<Eigen::Vector3d>& points() const { return points_; }  ///< The finite ones.
  const PointTree& tree() const { return *tree_; }

 private:
  std::vector<Eigen::Vector3d> points_;
  std::unique_ptr<const PointTree> tree_;
};

/// Compares each point of `a` with the plane through its nearest points in `b`. Doubled edges and
/// ghosts ("hallucinations" in the paper) show as large distances; points without a partner are not
/// counted.
CloudAgreement CompareClouds(const PointCloud& a, const Rigid3d& b_from_a, const ReferenceCloud& b,
                             const AgreementOptions& options = {});

}  // namespace sextant
