// SPDX-License-Identifier: Apache-2.0
// Exact pixels of random scenes: every solver of a whole pose recovers all of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <string>

#include "base/random.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "support/scenes.h"

namespace sextant {
namespace {

struct ExactCase {
  std::string spec;
  bool planar;
  double depth_m;
};

void PrintTo(const ExactCase& c, std::ostream* out) {
  *out << c.spec << (c.planar ? " planar " : " ") << c.depth_m << " m";
}

class ExactPixels : public testing::TestWithParam<ExactCase> {
 protected:
  // Rotation [rad] or translation over the depth, whichever is larger, of the nearest of the
  // answer and its alternatives; infinite where there is none.
  static double Error(const Expected<SolveReport>& report, const Rigid3d& truth) {
    double error = std::numeric_limits<double>::infinity();
    if (!report) return error;
    std::vector<Rigid3d> poses = report->alternatives;
    poses.push_back(report->cam_from_lidar);
    for (const Rigid3d& pose : poses) {
      const PoseDistance distance = DistanceBetween(pose, truth);
      error = std::min(
          error, std::max(distance.rotation_rad, distance.translation_m / GetParam().depth_m));
    }
    return error;
  }
};

TEST_P(ExactPixels, AreExplainedByTheTruePose) {
  const ExactCase& c = GetParam();
  const Expected<SolverPtr> solver = BuiltinSolvers().Make(c.spec);
  ASSERT_TRUE(solver) << solver.error().message;
  for (const int pairs : {4, 5, 6, 8, 20, 1000}) {
    if (pairs < (*solver)->spec().needs.pairs_2d3d) continue;
    const int scenes = pairs > 100 ? 5 : 200;
    Random random(DeriveSeed(1, "exact pixels", static_cast<std::uint64_t>(pairs), c.planar));
    double worst = 0.0;
    int wrong = 0;
    for (int trial = 0; trial < scenes; ++trial) {
      // Near the camera a smaller cube, which stays in front of it.
      const test::PairScene scene = test::MakeScene({.pairs = pairs,
                                                     .planar = c.planar,
                                                     .depth_m = c.depth_m,
                                                     .extent_m = std::min(1.0, 0.5 * c.depth_m)},
                                                    random);
      const double error = Error((*solver)->Solve(scene.problem), scene.cam_from_lidar);
      worst = std::max(worst, error);
      if (!(error < 1e-8)) ++wrong;
    }
    EXPECT_EQ(wrong, 0) << pairs << " pairs; largest error " << worst;
  }
}

std::vector<ExactCase> ExactCases() {
  std::vector<ExactCase> cases;
  for (const double depth_m : {1.0, 3.0, 20.0}) {
    for (const char* spec : {"epnp", "sqpnp", "p3p", "refine(epnp)"}) {
      cases.push_back({spec, false, depth_m});
      cases.push_back({spec, true, depth_m});
    }
    cases.push_back({"ippe", true, depth_m});
    cases.push_back({"dlt", false, depth_m});
  }
  return cases;
}

std::string ExactCaseName(const testing::TestParamInfo<ExactCase>& info) {
  const ExactCase& c = info.param;
  std::string name =
      c.spec + (c.planar ? "_planar_" : "_") + std::to_string(static_cast<int>(c.depth_m)) + "m";
  std::replace(name.begin(), name.end(), '(', '_');
  std::erase(name, ')');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Every, ExactPixels, testing::ValuesIn(ExactCases()), ExactCaseName);

}  // namespace
}  // namespace sextant
