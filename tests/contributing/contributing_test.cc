// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "base/random.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "support/scenes.h"

namespace sextant {

SolverEntry MySolverEntry();  // Compiled from the page.

namespace {

TEST(Contributing, TheSolverOnThePageFindsThePose) {
  SolverRegistry registry = BuiltinSolvers();
  registry.Add(MySolverEntry());
  const Expected<SolverPtr> solver = registry.Make("my_solver");
  ASSERT_TRUE(solver) << solver.error().message;
  Random random(1);
  const test::PairScene scene = test::MakeScene({}, random);
  const Expected<SolveReport> report = (*solver)->Solve(scene.problem);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_LT(DistanceBetween(report->cam_from_lidar, scene.cam_from_lidar).translation_m, 1e-9);
}

}  // namespace
}  // namespace sextant
