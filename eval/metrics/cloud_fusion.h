// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "geometry/point_cloud.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// All finite points of the clouds in one frame, the clouds one after the other. Intensities are
/// kept where every cloud has them; rings and times belong to one sensor and are not.
/// Requires one pose a cloud: target_from_cloud.
PointCloud FuseClouds(std::span<const PointCloud> clouds,
                      std::span<const Rigid3d> target_from_cloud);

/// How far two clouds of the same place are apart where both see the same surface.
struct CloudAgreement {
  int points = 0;    ///< Of `a`, finite.
  int compared = 0;  ///< Of them, near a flat patch of `b`.
  /// Of the distances to those patches [m], along their normals; NaN where nothing was compared.
  double median_m = 0.0;
  double rms_m = 0.0;

  double Overlap() const { return points == 0 ? 0.0 : 1.0 * compared / points; }
};

struct AgreementOptions {
  double reach_m = 0.2;  ///< Farther from every point of `b`: something that only `a` sees.
  /// A patch is the plane of the nearest points of `b`, flat where they spread at most this share
  /// of their extent across it.
  int neighbours = 12;
  double flatness = 0.2;
  int max_points = 20'000;  ///< Of `a`, evenly chosen: more only take longer.
};

/// Each point of `a` against the plane of its nearest points in `b`. Doubled edges and ghosts
/// ("hallucinations" in the paper) are large distances; points without a partner are not counted.
CloudAgreement CompareClouds(const PointCloud& a, const Rigid3d& b_from_a, const PointCloud& b,
                             const AgreementOptions& options = {});

}  // namespace sextant
