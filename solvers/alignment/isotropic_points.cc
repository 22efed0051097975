// SPDX-License-Identifier: Apache-2.0
#include "solvers/alignment/isotropic_points.h"

#include "solvers/kernels/kabsch_fit.h"

namespace sextant {

std::optional<Rigid3d> FitIsotropicPoints(std::span<const PointTerm> terms, PointBuffers& buffers) {
  buffers.in_cam.clear();
  buffers.in_lidar.clear();
  buffers.weights.clear();
  for (const PointTerm& term : terms) {
    const double inverse_sigma = term.whitener(0, 0);
    if (term.whitener != inverse_sigma * Eigen::Matrix3d::Identity()) return std::nullopt;
    buffers.in_cam.push_back(term.in_cam);
    buffers.in_lidar.push_back(term.in_lidar);
    buffers.weights.push_back(inverse_sigma * inverse_sigma);
  }
  const KabschOutcome fit = FitPoints(buffers.in_cam, buffers.in_lidar, buffers.weights);
  if (!fit) return std::nullopt;
  return fit->b_from_a;
}

}  // namespace sextant
