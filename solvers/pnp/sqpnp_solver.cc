// SPDX-License-Identifier: Apache-2.0
#include "solvers/core/registry.h"
#include "solvers/pnp/pnp_solver.h"
#include "solvers/pnp/sqpnp.h"

namespace sextant {

SolverEntry SqpnpEntry() {
  return {
      .name = "sqpnp",
      .summary = "global least squares of the distances from the lines of sight, times depth",
      .needs = "3 or more 2D-3D pairs, not on one line; with 3 the answer is ambiguous",
      .reference = "Terzakis and Lourakis 2020 (ECCV)",
      .example = "sqpnp",
      .make = [](const SolverArguments& arguments) -> Expected<SolverPtr> {
        return std::make_shared<PnpSolver>(
            SolverSpec{.name = arguments.name, .needs = {.pairs_2d3d = 3}},
            [](const PnpInput& input) -> Expected<PnpPoses> {
              const Expected<SqpnpFit> fit =
                  SolveSqpnp(input.image_points, input.points, input.choice);
              if (!fit) return tl::unexpected<Error>(fit.error());
              return PnpPoses{.poses = fit->cam_from_lidar, .count = fit->count};
            },
            PnpCovariance::kObjectSpace);
      },
  };
}

}  // namespace sextant
