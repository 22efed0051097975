// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/trust.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "base/random.h"
#include "calibrate/trust/outlier_views.h"
#include "calibrate/trust/select_views.h"
#include "geometry/random_vectors.h"
#include "io/problems/acfr_poses.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "support/real_data.h"

namespace sextant {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kSigma = 0.01;

const Rigid3d kTruth = {ExpSo3({1.2, -1.2, 1.2}), {0.1, -0.2, -0.1}};

// Views of four points each, each with its own noise; `stated` is the sigma that the pairs state.
// The points of a view lie within `extent` of its middle and have an error `shared` in common.
CalibrationProblem SomeViews(int views, std::uint64_t seed, double stated = kSigma,
                             double extent = 0.5, double shared = 0.0) {
  Random random(seed);
  CalibrationProblem problem;
  for (int view = 0; view < views; ++view) {
    Eigen::Vector3d middle(2.5, 0.0, 0.0);
    Eigen::Vector3d common = Eigen::Vector3d::Zero();
    if (shared > 0.0) {
      middle += 0.5 * NormalVector(random);
      common = shared * NormalVector(random);
    }
    for (int corner = 0; corner < 4; ++corner) {
      Pair3d3d pair;
      pair.id = {.view = view, .board = 0, .corner = corner};
      pair.point_in_lidar = middle + extent * NormalVector(random);
      pair.point_in_cam = kTruth * pair.point_in_lidar + common + kSigma * NormalVector(random);
      pair.sigma_m = stated;
      problem.pairs_3d3d.push_back(pair);
    }
  }
  return problem;
}

SolverPtr Kabsch() { return *BuiltinSolvers().Make("kabsch"); }

Trust TrustOf(const CalibrationProblem& problem, const TrustOptions& options = {}) {
  const SolverPtr solver = Kabsch();
  const Expected<SolveReport> answer = solver->Solve(problem);
  EXPECT_TRUE(answer) << answer.error().message;
  const Expected<Trust> trust = AssessTrust(problem, *solver, *answer, options);
  EXPECT_TRUE(trust) << trust.error().message;
  return *trust;
}

// Means over sessions, so that the tolerances are those of a mean.
TEST(Trust, CovarianceBootstrapAndCrossValidationAgreeWhereTheNoiseIsWhatIsStated) {
  constexpr int kSessions = 40;
  constexpr int kViews = 20;
  double bootstrap = 0.0;
  double jackknife = 0.0;
  double held_out = 0.0;
  double fit = 0.0;
  int inside = 0;
  for (int session = 0; session < kSessions; ++session) {
    const auto seed = static_cast<std::uint64_t>(session);
    const Trust trust = TrustOf(SomeViews(kViews, seed), {.bootstrap_samples = 100, .seed = seed});
    const TrustFigures& figures = trust.figures;
    bootstrap += *figures.bootstrap_over_solver / kSessions;
    jackknife += *figures.jackknife_over_solver / kSessions;
    held_out += std::pow(*figures.held_out_rmse_m / kSigma, 2) / 3.0 / kSessions;
    fit += std::pow(*figures.fit_rmse_m / kSigma, 2) / 3.0 / kSessions;
    EXPECT_EQ(figures.bootstrap->unanswered, 0);
    inside += (figures.bootstrap->low.array() < 0.0).all() &&
                      (figures.bootstrap->high.array() > 0.0).all()
                  ? 1
                  : 0;
  }
  // A standard deviation from 20 views has a relative error of 1 / sqrt(38), one from 10 folds 1 /
  // sqrt(18); 5 % for what both lose by the few that they are drawn from.
  EXPECT_NEAR(bootstrap, 1.0, 3.0 / std::sqrt(38.0 * kSessions) + 0.05);
  EXPECT_NEAR(jackknife, 1.0, 3.0 / std::sqrt(18.0 * kSessions) + 0.05);
  // 240 residuals, 6 parameters: fitted ones are smaller by 6 / 240, held-out ones larger by 6 /
  // 216.
  const double three_errors = 3.0 * std::sqrt(2.0 / (240.0 * kSessions));
  EXPECT_NEAR(fit, 1.0 - 6.0 / 240.0, three_errors);
  EXPECT_NEAR(held_out, 1.0 + 6.0 / 216.0, three_errors + 0.01);
  EXPECT_EQ(inside, kSessions);
}

// The solver widens its covariance to what the residuals show, as if they were independent: four
// points with one error are then taken for four measurements, and the ratio is about 2.
TEST(Trust, SaysWhereTheStatedNoiseIsTooSmall) {
  const Trust trust = TrustOf(SomeViews(30, 5, kSigma, 0.05, 10.0 * kSigma));
  EXPECT_GT(*trust.figures.bootstrap_over_solver, 1.5);
  EXPECT_THAT(trust.figures.comparison, HasSubstr("times what the noise model allows"));
  EXPECT_THAT(TrustOf(SomeViews(30, 5)).figures.comparison, HasSubstr("They agree within"));
  EXPECT_THAT(TrustOf(SomeViews(30, 5, 5.0 * kSigma)).figures.comparison,
              HasSubstr("it is cautious"));
}

TEST(Trust, NamesTheViewsThatDoNotBelong) {
  CalibrationProblem problem = SomeViews(12, 7);
  for (Pair3d3d& pair : problem.pairs_3d3d) {
    if (pair.id.view == 3) pair.point_in_lidar += Eigen::Vector3d(0.3, 0.0, 0.1);
    if (pair.id.view == 8) pair.point_in_lidar += Eigen::Vector3d(0.0, 0.2, 0.0);
  }
  const Trust trust = TrustOf(problem);
  EXPECT_THAT(trust.figures.outlier_views, ElementsAre(3, 8));
  EXPECT_THAT(trust.figures.comparison, HasSubstr("2 views disagree with the others"));
  EXPECT_TRUE(trust.views[8].outlier);
  EXPECT_GT(*trust.views[3].held_out_m, 0.2);
}

TEST(Trust, GoodViewsAreNotCalledOutliers) {
  std::size_t marked = 0;
  for (std::uint64_t seed = 100; seed < 150; ++seed) {
    marked += TrustOf(SomeViews(20, seed), {.bootstrap_samples = 0}).figures.outlier_views.size();
  }
  // Beyond four standard deviations of a chi of 12 degrees of freedom: about 1 in 3000.
  EXPECT_LE(marked, 3U);
}

TEST(Trust, TooFewViewsGiveAWarning) {
  const Trust one = TrustOf(SomeViews(1, 1));
  EXPECT_EQ(one.figures.folds, 0);
  EXPECT_FALSE(one.figures.bootstrap || one.figures.held_out_rmse_m);
  EXPECT_TRUE(one.figures.solver_sigma && one.figures.fit_rmse_m);
  EXPECT_THAT(one.figures.comparison, HasSubstr("One view alone"));
  const Trust two = TrustOf(SomeViews(2, 1));
  EXPECT_EQ(two.figures.folds, 2);
  EXPECT_TRUE(two.figures.held_out_rmse_m);
  EXPECT_THAT(two.figures.comparison, HasSubstr("too few for a bootstrap"));
  EXPECT_THAT(two.figures.outlier_views, IsEmpty());
  const Expected<Trust> none = AssessTrust({}, *Kabsch(), {}, {});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kMissingData);
}

TEST(Trust, DrawsWithoutAnAnswerAreCounted) {
  // Views of one point: a draw that holds fewer than three of them has no answer.
  CalibrationProblem problem = SomeViews(3, 9);
  std::erase_if(problem.pairs_3d3d, [](const Pair3d3d& pair) { return pair.id.corner > 0; });
  const Trust trust = TrustOf(problem);
  // All three are drawn with probability 6 / 27; the one answer that they give has no scatter.
  const BootstrapFigures& bootstrap = *trust.figures.bootstrap;
  EXPECT_NEAR(bootstrap.samples, 200.0 * 6.0 / 27.0, 3.0 * std::sqrt(200.0 * 0.22 * 0.78));
  EXPECT_EQ(bootstrap.samples + bootstrap.unanswered, 200);
  EXPECT_FALSE(trust.figures.jackknife_sigma);
}

TEST(Trust, IsTheSameOnAnyNumberOfThreads) {
  const CalibrationProblem problem = SomeViews(9, 11);
  const Trust parallel = TrustOf(problem);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Trust serial = TrustOf(problem);
  EXPECT_EQ(parallel.figures.bootstrap->low, serial.figures.bootstrap->low);
  EXPECT_EQ(parallel.figures.bootstrap_sigma, serial.figures.bootstrap_sigma);
  EXPECT_EQ(parallel.figures.jackknife_sigma, serial.figures.jackknife_sigma);
  EXPECT_EQ(parallel.figures.comparison, serial.figures.comparison);
}

TEST(Trust, GoesIntoTheResult) {
  const Trust trust = TrustOf(SomeViews(5, 3));
  CalibrationResult result;
  for (const int view : {4, 2, 17}) result.views.push_back({.view = view});
  AddTrust(trust, result);
  EXPECT_EQ(result.views[0].held_out_m, trust.views[4].held_out_m);
  EXPECT_EQ(result.views[1].rmse_m, trust.views[2].rmse_m);
  EXPECT_FALSE(result.views[2].rmse_m);
  EXPECT_EQ(result.trust->comparison, trust.figures.comparison);
}

TEST(Trust, OutliersAreNamedAmongTheWarnings) {
  CalibrationProblem problem = SomeViews(8, 7);
  for (Pair3d3d& pair : problem.pairs_3d3d) {
    if (pair.id.view == 3) pair.point_in_lidar += Eigen::Vector3d(0.3, 0.0, 0.1);
  }
  CalibrationResult result;
  result.views.push_back({.view = 2, .name = "good"});
  result.views.push_back({.view = 3, .name = "pose7"});
  AddTrust(TrustOf(problem), result);
  ASSERT_EQ(result.warnings.size(), 1U);
  EXPECT_THAT(result.warnings[0], HasSubstr("pose7 disagrees with the other views: under their"));
}

// The LiDAR turns by 1 deg between the views: no view alone contradicts the others.
TEST(HalvesDisagreement, ShowsASensorThatMoved) {
  constexpr int kSessions = 40;
  for (int session = 0; session < kSessions; ++session) {
    const auto seed = static_cast<std::uint64_t>(100 + session);
    CalibrationProblem problem = SomeViews(10, seed);
    EXPECT_LT(TrustOf(problem, {.bootstrap_samples = 10}).halves_off.value(), 4.0) << seed;
    for (Pair3d3d& pair : problem.pairs_3d3d) {
      if (pair.id.view >= 5) pair.point_in_lidar = ExpSo3({0.0, 0.0, 0.0175}) * pair.point_in_lidar;
    }
    EXPECT_GT(TrustOf(problem, {.bootstrap_samples = 10}).halves_off.value(), 3.0) << seed;
  }
}

TEST(HalvesDisagreement, NeedsFourGroups) {
  EXPECT_FALSE(TrustOf(SomeViews(3, 1), {.bootstrap_samples = 0}).halves_off);
}

TEST(DisagreeingViews, AreBeyondChanceByTheirOwnSigmas) {
  const std::vector<int> views = {3, 5, 8, 9};
  const std::vector<ViewComparison> compared = {
      {3, true, 2.5}, {5, true, 3.2}, {8, true, 0.1}, {8, true, 4.0}};
  // Each of four boards may exceed 2.8 sigma; view 9 was left out.
  EXPECT_THAT(DisagreeingViews(compared, views), ElementsAre(false, true, true, true));
}

TEST(OutlyingViews, NeedsAMajorityAndAClearDistance) {
  EXPECT_THAT(OutlyingViews(std::vector<double>{1.0, 1.1, 9.0}), ElementsAre(false, false, false));
  EXPECT_THAT(OutlyingViews(std::vector<double>{1.0, 1.1, 0.9, 9.0}),
              ElementsAre(false, false, false, true));
  EXPECT_THAT(OutlyingViews(std::vector<double>{1.0, 1.0, 1.0, 1.0, 1.5}),
              ElementsAre(false, false, false, false, false));
}

TEST(SelectViews, TakesOrDrawsWholeViews) {
  CalibrationProblem problem = SomeViews(4, 2);
  problem.boards = {{.id = 0, .top_right_m = 0.5, .right_bottom_m = 0.5}};
  problem.board_views = {{.view = 1}, {.view = 3}};
  EXPECT_THAT(ViewsOf(problem), ElementsAre(0, 1, 2, 3));
  const std::vector<int> some = {1, 2};
  const CalibrationProblem selected = SelectViews(problem, some);
  EXPECT_THAT(ViewsOf(selected), ElementsAre(1, 2));
  EXPECT_EQ(selected.pairs_3d3d.size(), 8U);
  EXPECT_EQ(selected.point_sets.in_lidar.size(), 8U);
  EXPECT_EQ(selected.board_views.size(), 1U);
  EXPECT_EQ(selected.boards.size(), 1U);
  const std::vector<int> drawn = {3, 1, 3};
  const CalibrationProblem twice = ResampleViews(problem, drawn);
  EXPECT_THAT(ViewsOf(twice), ElementsAre(0, 1, 2));
  EXPECT_EQ(twice.pairs_3d3d[0].point_in_cam, twice.pairs_3d3d[8].point_in_cam);
  EXPECT_EQ(twice.board_views.size(), 3U);
}

// Corner i against the LiDAR's corner in the order that most poses of the file have: six poses of
// another labelling do not fit any of the others.
TEST(Trust, NamesTheRelabelledPosesOfTheRealFile) {
  SEXTANT_REAL_DATA(path, "acfr_vlp16/poses.csv");
  const auto poses = ReadAcfrPoses(path);
  ASSERT_TRUE(poses) << poses.error().message;
  CalibrationProblem problem;
  for (std::size_t view = 0; view < poses->size(); ++view) {
    for (int corner = 0; corner < 4; ++corner) {
      Pair3d3d pair;
      pair.id = {.view = static_cast<int>(view), .board = 0, .corner = corner};
      pair.point_in_cam = (*poses)[view].in_cam.corners_m[static_cast<std::size_t>(corner)];
      pair.point_in_lidar = (*poses)[view].in_lidar.corners_m[static_cast<std::size_t>(3 - corner)];
      problem.pairs_3d3d.push_back(pair);
    }
  }
  std::vector<int> named;
  for (const int view : TrustOf(problem).figures.outlier_views) {
    named.push_back((*poses)[static_cast<std::size_t>(view)].id);
  }
  EXPECT_THAT(named, ElementsAre(7, 16, 17, 30, 31, 32));
}

}  // namespace
}  // namespace sextant
