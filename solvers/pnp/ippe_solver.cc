// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "solvers/core/registry.h"
#include "solvers/pnp/ippe.h"
#include "solvers/pnp/pnp_solver.h"

namespace sextant {

SolverEntry IppeEntry() {
  return {
      .name = "ippe",
      .summary = "both poses of a plane from the first order of its homography, each polished",
      .needs = "4 or more 2D-3D pairs on one plane, not three of four on one line",
      .reference = "Collins and Bartoli 2014 (IJCV 109)",
      .example = "ippe",
      .make = [](const SolverArguments& arguments) -> Expected<SolverPtr> {
        const auto kernel = [](const PnpInput& input) -> Expected<PnpPoses> {
          SEXTANT_ASSIGN_OR_RETURN(const IppeFit fit, SolveIppe(input.image_points, input.points));
          PnpPoses poses{.poses = {}, .count = fit.count};
          std::copy_n(fit.cam_from_lidar.begin(), fit.count, poses.poses.begin());
          return poses;
        };
        return std::make_shared<PnpSolver>(
            SolverSpec{.name = arguments.name, .needs = {.pairs_2d3d = 4, .points_on_plane = true}},
            kernel, PnpCovariance::kObjectSpace);
      },
  };
}

}  // namespace sextant
