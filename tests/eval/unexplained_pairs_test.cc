// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/unexplained_pairs.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

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

SolveReport ReportAt(const CalibrationProblem& problem, const Rigid3d& pose,
                     std::vector<int> inliers) {
  SolveReport report;
  report.cam_from_lidar = pose;
  report.inliers = std::move(inliers);
  report.evaluation = Evaluate(problem, pose);
  return report;
}

// Any three pixels fit a pose; the fourth says that this one is wrong.
TEST(WhyUnusable, ThreeOfFourAreNoEvidence) {
  const CalibrationProblem wrong = WidePixels(3000.0);
  const auto why = WhyUnusable(wrong, ReportAt(wrong, Rigid3d{}, {0, 1, 2}));
  ASSERT_TRUE(why);
  EXPECT_NE(why->find("3 of 4 pairs"), std::string::npos) << *why;
  const CalibrationProblem right = WidePixels(2.0);
  EXPECT_FALSE(WhyUnusable(right, ReportAt(right, Rigid3d{}, {0, 1, 2})));
  EXPECT_FALSE(WhyUnusable(right, ReportAt(right, Rigid3d{}, {0, 1, 2, 3})));
}

// Twelve pixels of a camera and points of a LiDAR at the same place.
CalibrationProblem TwelvePixels(double noise_px, std::uint64_t seed) {
  Random random(seed);
  CalibrationProblem problem = WidePixels(0.0);
  problem.pairs_2d3d.clear();
  for (int i = 0; i < 12; ++i) {
    Pair2d3d& pair = problem.pairs_2d3d.emplace_back();
    pair.point_in_lidar.x() = random.Uniform(-2.0, 2.0);
    pair.point_in_lidar.y() = random.Uniform(-1.5, 1.5);
    pair.point_in_lidar.z() = random.Uniform(2.0, 8.0);
    pair.pixel = *Project(*problem.camera, pair.point_in_lidar);
    pair.pixel.x() += noise_px * random.Normal();
    pair.pixel.y() += noise_px * random.Normal();
  }
  return problem;
}

// Pixels in degrees are a small image: the camera moves away until all points are near one pixel.
TEST(DescribeDistance, PixelsInDegreesMoveTheCameraAway) {
  int answers = 0;
  int said = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CalibrationProblem problem = TwelvePixels(1.0, seed);
    for (Pair2d3d& pair : problem.pairs_2d3d) {
      pair.pixel -= Eigen::Vector2d(problem.camera->cx_px, problem.camera->cy_px);
      pair.pixel *= 57.3 / problem.camera->fx_px;
    }
    for (const char* solver : {"ransac(p3p)", "refine(sqpnp)"}) {
      const auto report = BuiltinSolvers().Make(solver).value()->Solve(problem);
      if (!report) continue;
      ++answers;
      if (WhyUnusable(problem, *report) || DescribeDistance(problem, *report)) ++said;
    }
  }
  EXPECT_GT(said, answers * 9 / 10) << answers;
}

TEST(WhyUnusable, NothingIsSaidOfMeasurements) {
  int said = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const CalibrationProblem problem = TwelvePixels(seed % 2 == 0 ? 2.0 : 10.0, seed);
    for (const char* solver : {"ransac(p3p)", "refine(sqpnp)", "refine(sqpnp,loss=cauchy)"}) {
      const auto report = BuiltinSolvers().Make(solver).value()->Solve(problem);
      ASSERT_TRUE(report) << report.error().message;
      if (WhyUnusable(problem, *report) || DescribeDistance(problem, *report)) ++said;
      if (DescribeSelection(problem, *report)) ++said;
      EXPECT_TRUE(IsSupported(problem, *report));
    }
  }
  EXPECT_LT(said, 9);
}

// Twelve pairs have equal noise, and the answer is based on the seven that a pose happens to fit
// best.
TEST(DescribeSelection, OfPairsThatFitBest) {
  const CalibrationProblem problem = TwelvePixels(2.0, 1);
  SolveReport report = ReportAt(problem, Rigid3d{}, {});
  std::vector<double>& residuals = report.evaluation.per_pair_px;
  residuals = {0.1, 0.2, 0.2, 0.1, 0.3, 0.2, 0.1, 1.0, 1.1, 1.2, 1.3, 1.4};
  report.inliers = {0, 1, 2, 3, 4, 5, 6};
  EXPECT_FALSE(DescribeSelection(problem, report));  // The pairs may state their noise.
  report.noise.emplace().sigma_px = 0.2;
  EXPECT_TRUE(DescribeSelection(problem, report));
  for (std::size_t i = 7; i < residuals.size(); ++i) residuals[i] = 200.0;
  EXPECT_FALSE(DescribeSelection(problem, report));  // These are outliers.
}

TEST(IsSupported, ByHalfOfThePairsOrFarBeyondChance) {
  CalibrationProblem problem = TwelvePixels(1.0, 1);
  const CalibrationProblem more = TwelvePixels(1.0, 2);
  problem.pairs_2d3d.insert(problem.pairs_2d3d.end(), more.pairs_2d3d.begin(),
                            more.pairs_2d3d.end());
  EXPECT_TRUE(
      IsSupported(problem, ReportAt(problem, Rigid3d{}, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11})));
  EXPECT_TRUE(IsSupported(problem, ReportAt(problem, Rigid3d{}, {0, 1, 2, 3, 4, 5, 6, 7, 8})));
  EXPECT_FALSE(IsSupported(problem, ReportAt(problem, Rigid3d{}, {0, 1, 2, 3})));
}

}  // namespace
}  // namespace sextant
