// SPDX-License-Identifier: Apache-2.0
#include "solvers/core/stated_noise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/random.h"
#include "geometry/camera.h"
#include "solvers/builtin_solvers.h"

namespace sextant {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

// Corners whose depth the camera knows ten times worse than the rest, and their pixels. The pairs
// state `stated` times their noise.
CalibrationProblem PairsThatState(double stated, std::uint64_t seed) {
  const Eigen::Vector3d sigmas_m(0.001, 0.001, 0.01);
  Random random(seed);
  const auto normal = [&random] { return random.Normal(); };
  CalibrationProblem problem;
  problem.camera = Camera{.width_px = 1200,
                          .height_px = 800,
                          .fx_px = 700.0,
                          .fy_px = 700.0,
                          .cx_px = 600.0,
                          .cy_px = 400.0};
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d point(random.Uniform(2.0, 4.0), random.Uniform(-1.0, 1.0),
                                random.Uniform(-1.0, 1.0));
    const Eigen::Vector3d in_cam(-point.y(), -point.z(), point.x());
    Pair3d3d& corner = problem.pairs_3d3d.emplace_back();
    corner.point_in_lidar = point;
    corner.point_in_cam =
        in_cam + sigmas_m.cwiseProduct(Eigen::Vector3d(normal(), normal(), normal()));
    corner.covariance_in_cam = (stated * sigmas_m).cwiseAbs2().asDiagonal();
    Pair2d3d& pixel = problem.pairs_2d3d.emplace_back();
    pixel.point_in_lidar = point;
    pixel.pixel = *Project(*problem.camera, in_cam) + Eigen::Vector2d(normal(), normal());
    pixel.sigma_px = stated;
  }
  return problem;
}

class StatedNoise : public testing::TestWithParam<const char*> {
 protected:
  SolveReport Solve(const CalibrationProblem& problem) const {
    return BuiltinSolvers().Make(GetParam()).value()->Solve(problem).value();
  }
};

INSTANTIATE_TEST_SUITE_P(Solvers, StatedNoise,
                         testing::Values("kabsch", "eigen.umeyama", "epnp", "refine(epnp)",
                                         "refine(kabsch, on=3d3d)"));

TEST_P(StatedNoise, OfTheRightSizeOrLargerStays) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    EXPECT_THAT(Solve(PairsThatState(1.0, seed)).warnings, IsEmpty()) << seed;
    EXPECT_THAT(Solve(PairsThatState(2.0, seed)).warnings, IsEmpty()) << seed;
  }
}

// The ratio of variances is the smaller of two estimates of 1 from at least 34 residuals: each has
// a standard deviation of 0.24 and 0.35, the mean of 100 is below 1 by up to 0.35 / 2.
TEST_P(StatedNoise, ThatIsTooSmallIsSaidAndTheCovarianceIsThatOfTheResiduals) {
  constexpr int kSeeds = 100;
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const SolveReport answer = Solve(PairsThatState(0.3, seed));
    EXPECT_THAT(answer.warnings, Contains(HasSubstr("times what the pairs state"))) << seed;
    const SolveReport right = Solve(PairsThatState(1.0, seed));
    const double ratio = answer.covariance->trace() / right.covariance->trace();
    EXPECT_GT(ratio, 0.25) << seed;
    sum += ratio;
  }
  EXPECT_GT(sum / kSeeds, 0.8);
  EXPECT_LT(sum / kSeeds, 1.05);
}

// They have sentences of their own, and the sigmas of the other pairs are right.
TEST(StatedNoiseOfOutliers, DoesNotCount) {
  CalibrationProblem problem = PairsThatState(1.0, 7);
  for (const std::size_t i : {3U, 9U}) {
    problem.pairs_3d3d[i].point_in_cam.x() += 0.05;
    problem.pairs_2d3d[i].pixel.x() += 30.0;
  }
  const Expected<SolveReport> answer =
      BuiltinSolvers().Make("refine(epnp, loss=tukey)").value()->Solve(problem);
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_THAT(answer->warnings, Not(Contains(HasSubstr("times what the pairs state"))));
}

}  // namespace
}  // namespace sextant
