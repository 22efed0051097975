// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "geometry/rigid3d.h"
#include "solvers/kernels/pair_terms.h"

namespace sextant {

/// Kept between calls, so that none allocates.
struct PointBuffers {
  std::vector<Eigen::Vector3d> in_cam;
  std::vector<Eigen::Vector3d> in_lidar;
  std::vector<double> weights;
};

/// argmin of sum |whitener (in_cam - R in_lidar - t)|^2 in closed form (FitKabsch), where the noise
/// of every term is alike along all axes; none where it is not, or the points leave a turn free.
std::optional<Rigid3d> FitIsotropicPoints(std::span<const PointTerm> terms, PointBuffers& buffers);

}  // namespace sextant
