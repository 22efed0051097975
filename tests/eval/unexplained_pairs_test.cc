// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/unexplained_pairs.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "geometry/camera.h"
#include "solvers/builtin_solvers.h"

namespace sextant {
namespace {

CalibrationProblem PairsWithNoise(double sigma_m, std::uint64_t seed) {
  Random random(seed);
  CalibrationProblem problem;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d point(random.Uniform(2.0, 4.0), random.Uniform(-1.0, 1.0),
                                random.Uniform(-1.0, 1.0));
    const Eigen::Vector3d noise(random.Normal(), random.Normal(), random.Normal());
    Pair3d3d& pair = problem.pairs_3d3d.emplace_back();
    pair.point_in_lidar = point;
    pair.point_in_cam = Eigen::Vector3d(-point.y(), -point.z(), point.x()) + sigma_m * noise;
  }
  return problem;
}

std::optional<double> ShareOfKabsch(const CalibrationProblem& problem) {
  const auto solver = BuiltinSolvers().Make("kabsch");
  const auto report = (*solver)->Solve(problem);
  return report ? UnexplainedShare(problem, *report) : std::nullopt;
}

TEST(UnexplainedShare, IsSmallForMeasurementsAndLargeForUnrelatedPoints) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto measured = ShareOfKabsch(PairsWithNoise(0.05, seed));
    ASSERT_TRUE(measured);
    EXPECT_LT(*measured, 0.15) << seed;
    const auto unrelated = ShareOfKabsch(PairsWithNoise(3.0, seed));
    ASSERT_TRUE(unrelated) << seed;
    EXPECT_GT(*unrelated, kMaxUnexplainedShare) << seed;
  }
}

// Four corners of a wide image, of which one is another point's.
CalibrationProblem WidePixels(double wrong_px) {
  CalibrationProblem problem;
  problem.camera = Camera{.width_px = 6000,
                          .height_px = 4000,
                          .fx_px = 4000.0,
                          .fy_px = 4000.0,
                          .cx_px = 3000.0,
                          .cy_px = 2000.0};
  for (const Eigen::Vector3d& point :
       {Eigen::Vector3d(-2.0, -1.0, 4.0), Eigen::Vector3d(2.0, -1.0, 3.5),
        Eigen::Vector3d(2.0, 1.0, 4.0), Eigen::Vector3d(-2.0, 1.0, 5.0)}) {
    Pair2d3d& pair = problem.pairs_2d3d.emplace_back();
    pair.pixel = *Project(*problem.camera, point);
    pair.point_in_lidar = point;
  }
  problem.pairs_2d3d.back().pixel.x() += wrong_px;
  return problem;
}

TEST(UnexplainedShare, OfAWideImageIsAnAngle) {
  const auto share = [](double wrong_px) {
    const CalibrationProblem problem = WidePixels(wrong_px);
    const auto report = BuiltinSolvers().Make("refine(sqpnp)").value()->Solve(problem);
    return UnexplainedShare(problem, report.value()).value();
  };
  EXPECT_LT(share(4.0), 0.02);
  EXPECT_GT(share(800.0), kMaxUnexplainedShare);
}

TEST(UnexplainedShare, NeedsFourPairs) {
  CalibrationProblem problem = PairsWithNoise(0.01, 1);
  problem.pairs_3d3d.resize(3);
  EXPECT_FALSE(ShareOfKabsch(problem));
}

}  // namespace
}  // namespace sextant
