// SPDX-License-Identifier: Apache-2.0
// Pairs from the field that state no noise: the solvers find it, and who is an outlier under it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "base/random.h"
#include "io/cameras/camera_file.h"
#include "io/problems/pairs_csv.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "support/real_data.h"

namespace sextant {
namespace {

constexpr int kSeeds = 20;
constexpr int kResamples = 300;

/// The pairs and the camera of a case; skipped where the folder is absent.
struct FieldCase {
  CalibrationProblem problem;
  std::vector<int> good;  ///< Pairs that are no outliers, ascending.
};

FieldCase ReadCase(const std::filesystem::path& pairs, const char* camera,
                   const std::vector<int>& bad_rows) {
  FieldCase found;
  found.problem = ReadPairsCsv(pairs).value();
  found.problem.camera = ReadCamera(pairs.parent_path() / camera).value();
  for (int i = 0; i < static_cast<int>(found.problem.pairs_2d3d.size()); ++i) {
    if (std::find(bad_rows.begin(), bad_rows.end(), i + 1) == bad_rows.end()) {
      found.good.push_back(i);
    }
  }
  return found;
}

CalibrationProblem OfRows(const CalibrationProblem& problem, const std::vector<int>& rows) {
  CalibrationProblem chosen;
  chosen.camera = problem.camera;
  for (const int i : rows) {
    chosen.pairs_2d3d.push_back(problem.pairs_2d3d[static_cast<std::size_t>(i)]);
  }
  return chosen;
}

Expected<SolveReport> Answer(const std::string& spec, const CalibrationProblem& problem) {
  SEXTANT_ASSIGN_OR_RETURN(const SolverPtr solver, BuiltinSolvers().Make(spec));
  return solver->Solve(problem);
}

/// Standard deviations of a solver's answer over resampled boards, about its answer to all good
/// pairs; of pairs where no boards are named.
Vector6d BootstrapSigmas(const FieldCase& of, const char* solver) {
  const Expected<SolveReport> all = Answer(solver, OfRows(of.problem, of.good));
  if (!all) {
    ADD_FAILURE() << solver << ": " << all.error().message;
    return Vector6d::Zero();
  }
  std::map<std::pair<int, int>, std::vector<int>> boards;
  for (const int i : of.good) {
    const PairId& id = of.problem.pairs_2d3d[static_cast<std::size_t>(i)].id;
    boards[{id.view, id.board}].push_back(i);
  }
  std::vector<std::vector<int>> groups;
  for (auto& [key, rows] : boards) groups.push_back(std::move(rows));
  Random random(1);
  Vector6d squares = Vector6d::Zero();
  int count = 0;
  for (int k = 0; k < kResamples; ++k) {
    std::vector<int> rows;
    for (std::size_t i = 0; i < groups.size(); ++i) {
      const std::vector<int>& group = groups[random.Below(groups.size())];
      rows.insert(rows.end(), group.begin(), group.end());
    }
    const Expected<SolveReport> resampled = Answer(solver, OfRows(of.problem, rows));
    if (!resampled) continue;
    squares += PoseDifference(resampled->cam_from_lidar, all->cam_from_lidar).cwiseAbs2();
    ++count;
  }
  EXPECT_GT(count, kResamples / 2);
  return (squares / count).cwiseSqrt();
}

std::vector<std::string> RobustSpecs(int seed) {
  const std::string s = std::to_string(seed);
  return {"ransac(p3p,seed=" + s + ")",
          "ransac(epnp,seed=" + s + ")",
          "ransac(sqpnp,seed=" + s + ")",
          "gnc(epnp)",
          "gnc(sqpnp)",
          "gnc(ransac(p3p,seed=" + s + "))",
          "drop_worst(sqpnp)",
          "drop_worst(refine(sqpnp))",
          "refine(ransac(p3p,seed=" + s + "))",
          "refine(ransac(p3p,seed=" + s + "),loss=huber)",
          "refine(sqpnp,loss=cauchy)",
          "refine(sqpnp,loss=tukey)",
          "refine(epnp,loss=barron)",
          "refine(sqpnp,loss=huber)"};
}

struct Goals {
  Eigen::Vector3d translation;  ///< The right value [m].
  double sigma_ratio;           ///< Largest ratio of stated and bootstrap sigma; 0: not compared.
  bool says_too_few = false;    ///< The boards are too few to tell.
  double rounding = 1e-5;       ///< Rounding of the right value, and of the minimum [m].
};

void ExpectEveryRobustSolverIsRight(const FieldCase& of, const Goals& goals) {
  const Expected<SolveReport> right = Answer("refine(sqpnp)", OfRows(of.problem, of.good));
  ASSERT_TRUE(right) << right.error().message;
  EXPECT_LT((right->cam_from_lidar.translation - goals.translation).cwiseAbs().maxCoeff(),
            goals.rounding);
  const Vector6d bootstrap = BootstrapSigmas(of, "refine(sqpnp)");
  for (int seed = 1; seed <= kSeeds; ++seed) {
    for (const std::string& spec : RobustSpecs(seed)) {
      // Those without a seed once.
      if (seed > 1 && spec.find("seed") == std::string::npos) continue;
      const Expected<SolveReport> report = Answer(spec, of.problem);
      ASSERT_TRUE(report) << spec << ": " << report.error().message;
      const Vector6d off = PoseDifference(report->cam_from_lidar, right->cam_from_lidar);
      ASSERT_TRUE(report->noise && report->covariance) << spec;
      const Vector6d sigmas = report->covariance->diagonal().cwiseSqrt();
      for (int axis = 0; axis < 6; ++axis) {
        EXPECT_LT(std::abs(off[axis]), 3.0 * bootstrap[axis]) << spec << ", axis " << axis;
        if (goals.sigma_ratio == 0.0) continue;
        EXPECT_LT(sigmas[axis], goals.sigma_ratio * bootstrap[axis]) << spec << ", axis " << axis;
        EXPECT_GT(sigmas[axis], bootstrap[axis] / goals.sigma_ratio) << spec << ", axis " << axis;
      }
      EXPECT_EQ(report->noise->board_errors == BoardErrors::kTooFewBoards, goals.says_too_few);
    }
  }
}

TEST(UnknownNoise, OneWrongLineOf92) {
  SEXTANT_REAL_DATA(pairs, "../cases/bad_line_92_pairs/pairs_with_boards.csv");
  ExpectEveryRobustSolverIsRight(ReadCase(pairs, "camera.yaml", {82}),
                                 {{0.045846, -0.070774, -0.027639}, 2.0});
}

TEST(UnknownNoise, ThreeOutliersOf104) {
  SEXTANT_REAL_DATA(pairs, "../cases/three_outliers_104_pairs/pairs.csv");
  ExpectEveryRobustSolverIsRight(ReadCase(pairs, "camera_ros.yaml", {20, 87, 96}),
                                 {{-0.10434, 0.15380, -0.16840}, 2.0});
}

TEST(UnknownNoise, TwelvePairsOfThreeBoardsAreAllUsed) {
  SEXTANT_REAL_DATA(pairs, "../cases/boards_12_pairs/pairs_with_boards.csv");
  const FieldCase boards = ReadCase(pairs, "camera.yaml", {});
  ExpectEveryRobustSolverIsRight(boards, {{-0.0562, -0.0680, -0.0917}, 0.0, true, 6e-5});
  const Expected<SolveReport> report = Answer("ransac(p3p)", boards.problem);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->inliers.size(), 12U);
  EXPECT_FALSE(report->warnings.empty());
}

TEST(UnknownNoise, OfPoints) {
  SEXTANT_REAL_DATA(pairs, "../cases/units_and_roles/v_good.csv");
  const CalibrationProblem problem = ReadPairsCsv(pairs).value();
  const Expected<SolveReport> right = Answer("kabsch", problem);
  ASSERT_TRUE(right && right->covariance);
  for (const char* spec : {"ransac(kabsch)", "gnc(kabsch)", "clique(kabsch)", "robust(kabsch)",
                           "drop_worst(kabsch)", "refine(kabsch,loss=huber)"}) {
    const Expected<SolveReport> report = Answer(spec, problem);
    ASSERT_TRUE(report && report->covariance) << spec;
    const Vector6d sigmas = right->covariance->diagonal().cwiseSqrt();
    const Vector6d off = PoseDifference(report->cam_from_lidar, right->cam_from_lidar);
    for (int axis = 0; axis < 6; ++axis) {
      EXPECT_LT(std::abs(off[axis]), sigmas[axis]) << spec << ", axis " << axis;
      const double ratio = std::sqrt((*report->covariance)(axis, axis)) / sigmas[axis];
      EXPECT_NEAR(std::log(ratio), 0.0, std::log(1.5)) << spec << ", axis " << axis;
    }
  }
}

}  // namespace
}  // namespace sextant
