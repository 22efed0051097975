// SPDX-License-Identifier: Apache-2.0
// Properties that ransac, gnc, clique, robust and drop_worst share, compared with the inner solver
// on the true inliers: the oracle that no robust solver beats.
#include "support/outliers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>

#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"

namespace sextant {
namespace {

using test::AddOutliers;
using test::MakeScene;
using test::Only;
using test::PairScene;
using test::SceneOptions;

struct OutlierCase {
  std::string spec;
  std::string oracle;  ///< Solved on the true inliers.
  int pairs;
  double share;  ///< Share of outliers.
  int trials;
  double lost_pairs = 2.0;  ///< Share of the error allowed for pairs beyond the threshold.
};

void PrintTo(const OutlierCase& c, std::ostream* out) { *out << c.spec; }

class Outliers : public testing::TestWithParam<OutlierCase> {};

double SquaredError(const SolveReport& report, const Rigid3d& truth, const Matrix6d& scale) {
  const Vector6d error = PoseDifference(report.cam_from_lidar, truth);
  return error.dot(scale * error);
}

// Every trial finds the pose, and the RMS error is near the oracle's: only true pairs beyond the 99
// percent threshold are lost, which matters more where there are few.
TEST_P(Outliers, AnswersNearlyAsWellAsOnTheTrueInliers) {
  const OutlierCase& c = GetParam();
  const SceneOptions options{.pairs = c.pairs, .sigma_m = 0.005, .sigma_px = 1.0};
  const SolverRegistry registry = BuiltinSolvers();
  const Expected<SolverPtr> solver = registry.Make(c.spec);
  const Expected<SolverPtr> oracle = registry.Make(c.oracle);
  ASSERT_TRUE(solver && oracle) << c.spec;
  double squares = 0.0;
  double oracle_squares = 0.0;
  for (int trial = 0; trial < c.trials; ++trial) {
    Random random(DeriveSeed(1, "outliers", static_cast<std::uint64_t>(c.pairs),
                             static_cast<std::uint64_t>(trial)));
    PairScene scene = MakeScene(options, random);
    const std::vector<int> inliers = AddOutliers(c.share, options, random, scene);
    const Expected<SolveReport> report = (*solver)->Solve(scene.problem);
    ASSERT_TRUE(report) << "trial " << trial << ": " << report.error().message;
    const PoseDistance distance = DistanceBetween(report->cam_from_lidar, scene.cam_from_lidar);
    EXPECT_LT(distance.rotation_rad, 0.05) << "trial " << trial;
    EXPECT_LT(distance.translation_m, 0.15) << "trial " << trial;
    EXPECT_TRUE(std::is_sorted(report->inliers.begin(), report->inliers.end()));

    const Expected<SolveReport> best = (*oracle)->Solve(Only(scene.problem, inliers));
    ASSERT_TRUE(best && best->covariance);
    const Matrix6d scale = best->covariance->inverse();
    squares += SquaredError(*report, scene.cam_from_lidar, scale);
    oracle_squares += SquaredError(*best, scene.cam_from_lidar, scale);
  }
  const double true_pairs = std::round((1.0 - c.share) * c.pairs);
  EXPECT_LT(std::sqrt(squares / oracle_squares), 1.0 + c.lost_pairs / true_pairs);
}

// clique_test.cc has 95 percent outliers among 100 pairs.
std::vector<OutlierCase> OutlierCases() {
  return {
      {"ransac(kabsch)", "kabsch", 20, 0.0, 100},
      {"ransac(kabsch)", "kabsch", 20, 0.5, 100},
      {"ransac(kabsch)", "kabsch", 100, 0.8, 40},
      {"ransac(kabsch,sample_size=15,max_iterations=10000,local_optimisation=0,refit=inliers)",
       "kabsch", 20, 0.1, 40},
      {"gnc(kabsch)", "kabsch", 20, 0.0, 100},
      {"gnc(kabsch)", "kabsch", 20, 0.3, 100},
      {"gnc(kabsch)", "kabsch", 100, 0.6, 40},
      {"drop_worst(kabsch)", "kabsch", 20, 0.0, 100},
      {"drop_worst(kabsch)", "kabsch", 20, 0.2, 100},
      {"clique(kabsch)", "kabsch", 20, 0.0, 100},
      {"clique(kabsch)", "kabsch", 20, 0.5, 100},
      {"clique(kabsch)", "kabsch", 300, 0.9, 10},
      {"robust(kabsch)", "kabsch", 20, 0.0, 100},
      {"robust(kabsch)", "kabsch", 20, 0.5, 100},
      {"robust(kabsch)", "kabsch", 100, 0.2, 100},
      {"robust(kabsch)", "kabsch", 100, 0.5, 100},
      {"robust(kabsch)", "kabsch", 100, 0.8, 100},
      // Five pairs lost of 500 scatter the ratio of ten trials by 1.3 percent.
      {"robust(kabsch)", "kabsch", 1000, 0.5, 10, 20.0},
      {"robust(kabsch)", "kabsch", 1000, 0.95, 10},
      {"ransac(p3p)", "refine(p3p)", 20, 0.0, 100},
      {"ransac(p3p)", "refine(p3p)", 20, 0.5, 100},
      {"ransac(p3p)", "refine(p3p)", 100, 0.5, 100},
      {"refine(ransac(p3p))", "refine(p3p)", 100, 0.5, 100},
      {"ransac(p3p)", "refine(p3p)", 100, 0.8, 20},
      {"gnc(epnp)", "refine(epnp)", 20, 0.1, 100},
      // The graduated cost of pixels settles in minima with a pair less: 120 of 12000 true pairs
      // are lost here, where ransac loses 97.
      {"gnc(epnp)", "refine(epnp)", 100, 0.4, 100, 4.0},
      {"gnc(sqpnp)", "refine(sqpnp)", 20, 0.0, 100},
      {"gnc(sqpnp)", "refine(sqpnp)", 100, 0.3, 100, 4.0},
      {"ransac(epnp,sample_size=15,max_iterations=10000,local_optimisation=0,refit=inliers)",
       "epnp", 20, 0.1, 40},
  };
}

std::string OutlierCaseName(const testing::TestParamInfo<OutlierCase>& info) {
  std::string name = std::to_string(info.index) + "_" + info.param.spec + "_" +
                     std::to_string(info.param.pairs) + "_" +
                     std::to_string(std::lround(100.0 * info.param.share));
  std::replace_if(
      name.begin(), name.end(),
      [](char ch) { return std::isalnum(static_cast<unsigned char>(ch)) == 0; }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Every, Outliers, testing::ValuesIn(OutlierCases()), OutlierCaseName);

class Elimination : public testing::TestWithParam<std::string> {};

// The paper's elimination of 20 points to 11 and to 8, with four outliers: every kept pair is true.
TEST_P(Elimination, KeepsTruePairsOnly) {
  const SceneOptions options{.pairs = 20, .sigma_px = 1.0};
  const Expected<SolverPtr> solver = BuiltinSolvers().Make(GetParam());
  ASSERT_TRUE(solver) << solver.error().message;
  for (std::uint64_t trial = 0; trial < 100; ++trial) {
    Random random(DeriveSeed(3, "elimination", 0, trial));
    PairScene scene = MakeScene(options, random);
    const std::vector<int> inliers = AddOutliers(0.2, options, random, scene);
    const Expected<SolveReport> report = (*solver)->Solve(scene.problem);
    ASSERT_TRUE(report) << "trial " << trial << ": " << report.error().message;
    EXPECT_TRUE(std::includes(inliers.begin(), inliers.end(), report->inliers.begin(),
                              report->inliers.end()))
        << "trial " << trial;
    const PoseDistance distance = DistanceBetween(report->cam_from_lidar, scene.cam_from_lidar);
    EXPECT_LT(distance.rotation_rad, 0.05) << "trial " << trial;
    EXPECT_LT(distance.translation_m, 0.15) << "trial " << trial;
  }
}

INSTANTIATE_TEST_SUITE_P(Every, Elimination,
                         testing::Values("drop_worst(epnp,keep=11)", "drop_worst(epnp,keep=8)"),
                         [](const auto& spec) {
                           return spec.param.find("11") != std::string::npos ? "to_11" : "to_8";
                         });

// 200 of 5000 pairs are true: a solver finds them, or reports that there is no consensus.
TEST(ManyOutliers, AreSeenThroughOrReported) {
  const SceneOptions options{.pairs = 5000, .sigma_m = 0.01};
  Random random(DeriveSeed(4, "many outliers", 0, 0));
  PairScene scene = MakeScene(options, random);
  AddOutliers(0.96, options, random, scene);
  for (Pair3d3d& pair : scene.problem.pairs_3d3d) pair.id = {};
  for (const double sigma_m : {0.01, 0.0}) {
    for (Pair3d3d& pair : scene.problem.pairs_3d3d) pair.sigma_m = sigma_m;
    for (const char* spec : {"robust(kabsch)", "clique(kabsch)", "ransac(kabsch)", "gnc(kabsch)"}) {
      const Expected<SolveReport> report = (*BuiltinSolvers().Make(spec))->Solve(scene.problem);
      if (!report) {
        EXPECT_EQ(report.error().code, ErrorCode::kNoConsensus) << spec << report.error().message;
        continue;
      }
      const PoseDistance distance = DistanceBetween(report->cam_from_lidar, scene.cam_from_lidar);
      EXPECT_LT(distance.rotation_rad, 0.005) << spec;
      EXPECT_LT(distance.translation_m, 0.01) << spec;
      RecordProperty(std::string(spec) + (sigma_m > 0.0 ? "_known_ms" : "_unknown_ms"),
                     std::to_string(report->wall_time_us * 1e-3));
    }
  }
}

class NoConsensus : public testing::TestWithParam<std::string> {};

// At the stated rate of 0.01 false answers per problem, 40 problems would give more than 3 once in
// a thousand runs.
TEST_P(NoConsensus, IsReportedWhereEveryPairIsAnOutlier) {
  const Expected<SolverPtr> solver = BuiltinSolvers().Make(GetParam());
  ASSERT_TRUE(solver) << solver.error().message;
  int answers = 0;
  for (const int pairs : {6, 8, 20, 100}) {
    const SceneOptions options{.pairs = pairs, .sigma_m = 0.01, .sigma_px = 1.0};
    for (std::uint64_t trial = 0; trial < 10; ++trial) {
      Random random(DeriveSeed(2, "no consensus", static_cast<std::uint64_t>(pairs), trial));
      PairScene scene = MakeScene(options, random);
      AddOutliers(1.0, options, random, scene);
      const Expected<SolveReport> report = (*solver)->Solve(scene.problem);
      if (report) {
        ++answers;
        continue;
      }
      EXPECT_EQ(report.error().code, ErrorCode::kNoConsensus) << report.error().message;
    }
  }
  EXPECT_LE(answers, 3);
}

std::string OuterName(const testing::TestParamInfo<std::string>& spec) {
  std::string name = spec.param.substr(0, spec.param.find(')'));
  std::replace(name.begin(), name.end(), '(', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Every, NoConsensus,
                         testing::Values("ransac(kabsch)", "gnc(kabsch)", "clique(kabsch)",
                                         "robust(kabsch)", "drop_worst(kabsch)", "ransac(p3p)",
                                         "gnc(p3p)", "drop_worst(p3p)", "gnc(epnp)",
                                         "drop_worst(epnp)", "gnc(sqpnp)", "drop_worst(sqpnp)"),
                         OuterName);

// Where outliers leave the inner solver no pose of all pairs, or spoil it so that true pairs are
// dropped first.
class OutliersOfUnknownNoise : public testing::TestWithParam<const char*> {};

TEST_P(OutliersOfUnknownNoise, FourOfTenAreBorne) {
  constexpr int kTrials = 60;
  const SceneOptions options{.pairs = 30, .sigma_px = 1.0, .states_noise = false};
  int near = 0;
  for (std::uint64_t trial = 0; trial < kTrials; ++trial) {
    Random random(DeriveSeed(2, "outliers of unknown noise", 0, trial));
    PairScene scene = MakeScene(options, random);
    AddOutliers(0.4, options, random, scene);
    const auto report = BuiltinSolvers().Make(GetParam()).value()->Solve(scene.problem);
    if (!report) continue;
    if (DistanceBetween(report->cam_from_lidar, scene.cam_from_lidar).rotation_rad < 0.05) ++near;
  }
  EXPECT_GE(near, kTrials - 1);
}

INSTANTIATE_TEST_SUITE_P(Every, OutliersOfUnknownNoise,
                         testing::Values("gnc(p3p)", "gnc(sqpnp)", "drop_worst(epnp)"),
                         [](const auto& spec) { return std::to_string(spec.index); });

}  // namespace
}  // namespace sextant
