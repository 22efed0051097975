// SPDX-License-Identifier: Apache-2.0
#include "solvers/core/registry.h"
#include "solvers/pnp/epnp.h"
#include "solvers/pnp/pnp_solver.h"

namespace sextant {

SolverEntry EpnpEntry() {
  return {
      .name = "epnp",
      .summary = "pose from control points: kernel of the linear equations, then their lengths",
      .needs = "4 or more 2D-3D pairs, not on one line",
      .reference = "Lepetit, Moreno-Noguer and Fua 2009 (IJCV)",
      .example = "epnp",
      .make = [](const SolverArguments& arguments) -> Expected<SolverPtr> {
        return std::make_shared<PnpSolver>(
            SolverSpec{.name = arguments.name, .needs = {.pairs_2d3d = 4}},
            [](const PnpInput& input) -> Expected<PnpPoses> {
              const Expected<EpnpFit> fit =
                  SolveEpnp(input.image_points, input.points, input.choice);
              if (!fit) return tl::unexpected<Error>(fit.error());
              return PnpPoses{.poses = {fit->cam_from_lidar}, .count = 1};
            },
            EpnpOfMoments);
      },
  };
}

}  // namespace sextant
