// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "geometry/rigid3d.h"
#include "solvers/kernels/scans/scan_surfaces.h"

namespace sextant {

/// Matches the patches of one scan to planes of another at a pose.
class ScanMatch {
 public:
  /// Patches of `source`, planes of `target`; both must outlive this.
  ScanMatch(const ScanSurfaces& target, const ScanSurfaces& source);

  /// Matches each patch to the plane of the target's cell that it falls into. Normals more than 32
  /// degrees apart do not match.
  void Match(const Rigid3d& target_from_source);

  /// Normal equations of sum w r^2 over the matches, r = normal . (R p + t) - distance [m], by
  /// (dphi, dt) with the rotation about the target's origin: derivative (q x normal, normal) at
  /// q = R p + t.
  struct Equations {
    Matrix6d normal = Matrix6d::Zero();
    Vector6d right = Vector6d::Zero();  ///< Minus the gradient.
    double squares = 0.0;               ///< sum w r^2.
    int matches = 0;                    ///< With a weight above 0.
  };

  /// The weight is 1 / variance of r (noise of the patch's centroid and of the plane there), times
  /// Tukey's biweight (Beaton and Tukey 1974), which ends at the larger of gate_m and three
  /// standard deviations.
  Equations Linearise(const Rigid3d& target_from_source, double gate_m) const;

  /// Covariance of the noise in Linearise(pose, 0).right. Planes of neighbouring cells are fitted
  /// to the same returns: the nine cells that use the plane of one window share its noise.
  Matrix6d NoiseOfRight(const Rigid3d& target_from_source) const;

 private:
  const ScanSurfaces& target_;
  const ScanSurfaces& source_;
  std::vector<std::int32_t> plane_of_;  ///< The number of the plane that each patch is matched to.
};

}  // namespace sextant
